#include "mjdiag/discovery/answer/member_forces.h"

#include <algorithm>

#include "mjdiag/discovery/answer/missing_share.h"
#include "mjdiag/discovery/fit/tick_columns.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Of a column, rms at every joint with a latent force.
VectorXd SizesOf(const Column& column, const FilterPath& path,
                 const std::vector<MatrixXd>& force_of_change) {
  MatrixXd forces = MatrixXd::Zero(path.dof_count(), path.samples());
  for (const auto& [state, signal] : column.states) {
    for (Index k = 0; k < path.samples(); ++k) {
      if (signal[k] == 0.0) continue;
      forces.col(k) +=
          signal[k] *
          force_of_change[path.of_tick[static_cast<std::size_t>(k)]].col(state);
    }
  }
  return forces.rowwise().norm() / std::sqrt(static_cast<double>(path.samples()));
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
  std::vector<MatrixXd> force_of_change;
  for (const TickTangent& tangent : path.tangents) {
    force_of_change.push_back(
        PseudoInverse(tangent.B(Eigen::indexing::all, path.dofs)));
  }
  const VectorXd least =
      (kHundredth * SizesOf(columns.back(), path, force_of_change))
          .cwiseMax(kNegligible * UsualForces(machine, data.run.seen, path));
  std::vector<bool> idle(model.size(), false);
  for (std::size_t m = 0; m < model.size(); ++m) {
    if (ActsOnReadings(data.blocks[model[m].block])) continue;
    const VectorXd size = SizesOf(columns[m], path, force_of_change);
    idle[m] = (size.array() <= least.array()).all();
  }
  return idle;
}

}  // namespace mjdiag
