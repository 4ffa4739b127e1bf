#include "mjdiag/discovery/answer/member_forces.h"

#include <cmath>

#include "mjdiag/discovery/fit/tick_columns.h"
#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Of a column, rms at every joint, also where nothing is measured, for a mount acts there: what
/// makes its changes of the velocities in a tick where nothing holds the machine.
VectorXd SizesOf(const Column& column, const FilterPath& path, const MatrixXd& mass) {
  const Index nv = mass.rows();
  MatrixXd changes = MatrixXd::Zero(nv, path.samples());
  for (const auto& [state, signal] : column.states) {
    if (state >= nv && state < 2 * nv) changes.row(state - nv) = signal.transpose();
  }
  const VectorXd rms = (mass * changes).rowwise().norm() /
                       std::sqrt(static_cast<double>(path.samples()));
  return rms / path.sample_time;
}

bool ActsOnReadings(const Block& block) {
  return block.candidate && block.candidate->effect->site() == SiteKind::kSensor;
}

}  // namespace

std::vector<bool> NobodyWouldMiss(const AnswerData& data, const ModelOnRuns& answer) {
  constexpr double kHundredth = 0.01;
  const Model& model = answer.fit.model;
  const FilterPath& path = answer.seen;
  const Machine machine = data.With(model);
  std::vector<OtherMachine> others;
  for (std::size_t m = 0; m < model.size(); ++m) {
    others.push_back({data.With(Without(model, m))});
  }
  others.push_back({data.With({})});
  const std::vector<Column> columns = TickColumns(machine, data.run.seen, path, others);
  const MatrixXd& mass = machine.mechanics().M;
  const VectorXd least = kHundredth * SizesOf(columns.back(), path, mass);
  std::vector<bool> idle(model.size(), false);
  for (std::size_t m = 0; m < model.size(); ++m) {
    if (ActsOnReadings(data.blocks[model[m].block])) continue;
    const VectorXd size = SizesOf(columns[m], path, mass);
    idle[m] = (size.array() <= least.array()).all();
  }
  return idle;
}

}  // namespace mjdiag
