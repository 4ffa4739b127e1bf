#include "mjdiag/discovery/fit/other_friction.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "mjdiag/discovery/fit/moved_model.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// How far every joint of one degree of freedom went.
VectorXd StrokesOf(const mjModel& plant, const FilterPath& path) {
  VectorXd strokes = VectorXd::Zero(plant.nv);
  for (Index dof = 0; dof < plant.nv; ++dof) {
    const int joint = plant.dof_jntid[dof];
    if (plant.jnt_type[joint] != mjJNT_SLIDE && plant.jnt_type[joint] != mjJNT_HINGE) {
      continue;
    }
    const auto at = [&](const PlantState& state) {
      return state.position[plant.jnt_qposadr[joint]];
    };
    const auto [least, most] = std::ranges::minmax_element(path.states, {}, at);
    strokes[dof] = at(*most) - at(*least);
  }
  return strokes;
}

VectorXd FastestOf(const mjModel& plant, const FilterPath& path) {
  VectorXd fastest = VectorXd::Zero(plant.nv);
  for (const PlantState& state : path.states) {
    fastest = fastest.cwiseMax(state.velocity.cwiseAbs());
  }
  return fastest;
}

std::vector<Model> OtherForms(const ConvergedBeside& beside,
                              const ConvergedModel& found) {
  const Model& model = found.fit.model;
  std::vector<Model> forms{GivingWay(beside.blocks, model),
                           Abrupt(beside.blocks, model)};
  const Machine machine = beside.machine_with(model);
  const VectorXd strokes = StrokesOf(machine.plant(), found.path);
  // From what encoders tell of their stroke to what a regression sees.
  for (const double share : {1e-5, 1e-4, 1e-3}) {
    forms.push_back(Springing(beside.blocks, model, share * strokes));
  }
  const VectorXd fastest = FastestOf(machine.plant(), found.path);
  for (const double share : {0.003, 0.01, 0.03, 0.1}) {
    forms.push_back(BreakingAway(beside.blocks, model, share * fastest));
  }
  std::erase_if(forms, [&](const Model& one) { return HaveSameBlocks(one, model); });
  return forms;
}

/// Behind the noise that the model has; none where that cannot be better.
std::optional<ConvergedModel> Followed(const ConvergedBeside& beside,
                                       const Model& model,
                                       const ConvergedModel& found) {
  const FilterPath& like = found.path;
  FilterPath path = RunForceFilter(beside.machine_with(model), beside.run, like.dofs,
                                   like.starts, like.noise);
  // What is known of values, which takes a run for each, costs no less than nothing.
  double price = 0.0;
  for (const Member& member : model) price += beside.blocks[member.block].price;
  if (path.deviance + price > found.score() - kLeastGain) return std::nullopt;
  ModelFit fit = FitModel(beside.machine_with, beside.run, path, KeepGains(path),
                          beside.blocks, model, {});
  ConvergedModel one{std::move(fit), std::move(path)};
  if (one.score() > found.score() - kLeastGain) return std::nullopt;
  return one;
}

Index ValuesIn(const Model& model) {
  Index values = 0;
  for (const Member& member : model) values += member.values.size();
  return values;
}

/// What says more has to be worth a claim: beside what is still missing a shape is worth some
/// units.
double WithClaims(const ConvergedModel& one) {
  return one.score() + kClaim * static_cast<double>(ValuesIn(one.fit.model));
}

/// Where there is time, forms are compared as they are fitted: that which breaks away at
/// another speed than the law in its place knows is nowhere near before.
std::optional<ConvergedModel> BestFitted(const ConvergedBeside& beside,
                                         const std::vector<Model>& forms,
                                         const ConvergedModel& found) {
  // Each may come out best.
  const double hoped = std::max(kLeastGain, std::abs(found.score()));
  std::optional<ConvergedModel> best;
  for (auto& one : SettleInPlaceOf(found, beside, forms, hoped)) {
    if (!one || WithClaims(*one) > WithClaims(found) - kLeastGain) continue;
    if (!best || WithClaims(*one) < WithClaims(*best)) best = std::move(one);
  }
  return best;
}

}  // namespace

std::optional<ConvergedModel> WithOtherFriction(const ConvergedBeside& beside,
                                                const ConvergedModel& found,
                                                bool has_time) {
  const bool rubs = std::ranges::any_of(found.fit.model, [&](const Member& member) {
    return beside.blocks[member.block].IsDryFriction();
  });
  if (!rubs || beside.is_over()) return std::nullopt;
  const std::vector<Model> forms = OtherForms(beside, found);
  if (has_time) return BestFitted(beside, forms, found);
  std::vector<std::optional<ConvergedModel>> followed(forms.size());
  ParallelForAll(static_cast<int>(forms.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    try {
      followed[i] = Followed(beside, forms[i], found);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  });
  std::erase_if(followed, [](const auto& one) { return !one; });
  if (followed.empty()) return std::nullopt;
  ConvergedModel best = std::move(**std::ranges::min_element(
      followed, {}, [](const auto& one) { return one->score(); }));
  try {
    return SettleNear(beside, std::move(best.fit), std::move(best.path));
  } catch (const NumericalError&) {
    return std::nullopt;
  }
}

}  // namespace mjdiag
