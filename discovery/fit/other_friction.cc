#include "mjdiag/discovery/fit/other_friction.h"

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/fit/moved_model.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// The same blocks in the same places.
bool IsSame(const Model& a, const Model& b) {
  return std::ranges::equal(a, b, {}, &Member::block, &Member::block);
}

/// Behind the noise that the model has.
ConvergedModel Followed(const ConvergedBeside& beside, const Model& model,
                        const FilterPath& like) {
  FilterPath path = RunForceFilter(beside.machine_with(model), beside.run, like.dofs,
                                   like.starts, like.noise);
  ModelFit fit = FitModel(beside.machine_with, beside.run, path, KeepGains(path),
                          beside.blocks, model, 0);
  return {std::move(fit), std::move(path)};
}

}  // namespace

std::optional<ConvergedModel> WithOtherFriction(const ConvergedBeside& beside,
                                                const ConvergedModel& found) {
  const Model& model = found.fit.model;
  for (const Model& other :
       {GivingWay(beside.blocks, model), Abrupt(beside.blocks, model)}) {
    if (IsSame(other, model) || beside.is_over()) continue;
    try {
      ConvergedModel one = Followed(beside, other, found.path);
      if (one.score() > found.score() - kLeastGain) continue;
      return SettleNear(beside, std::move(one.fit), std::move(one.path));
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  }
  return std::nullopt;
}

}  // namespace mjdiag
