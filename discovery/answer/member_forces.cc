#include "mjdiag/discovery/answer/member_forces.h"

#include "mjdiag/discovery/fit/tick_columns.h"
#include "mjdiag/discovery/regression/negligible.h"
#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

namespace {

bool ActsOnReadings(const Block& block) {
  return block.candidate && block.candidate->effect->site() == SiteKind::kSensor;
}

}  // namespace

std::vector<bool> NobodyWouldMiss(const AnswerData& data, const ModelOnRuns& answer) {
  const Model& model = answer.fit.model;
  const FilterPath& path = answer.seen;
  const Machine machine = data.With(model);
  std::vector<OtherMachine> others;
  for (std::size_t m = 0; m < model.size(); ++m) {
    others.push_back({data.With(Without(model, m))});
  }
  others.push_back({data.With({})});
  const bool has_steps = data.steps.without == 0.0;
  if (!has_steps) {
    AnswerData other = data;
    other.steps = data.steps.Other();
    others.push_back({other.With(model)});
  }
  const std::vector<Column> columns = TickColumns(machine, data.run.seen, path, others);
  const Column* steps = has_steps ? nullptr : &columns.back();
  const Negligible negligible(data.machine, path, data.reading_sd,
                              {{1.0, &columns[model.size()]}}, steps);
  std::vector<bool> idle(model.size(), false);
  for (std::size_t m = 0; m < model.size(); ++m) {
    const std::vector<ScaledColumn> member{{1.0, &columns[m]}};
    idle[m] = ActsOnReadings(data.blocks[model[m].block]) ? negligible.IsError(member)
                                                          : negligible.IsForce(member);
  }
  return idle;
}

}  // namespace mjdiag
