#include "mjdiag/discovery/answer/fault_figures.h"

#include <cmath>
#include <utility>
#include <vector>

#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr Index kPartsOfRun = 10;

/// |theta| + 3 sd(theta).
/// @param phi  response of innovations to a change of the fault parameter by 1
double HiddenFault(const VectorXd& phi, const VectorXd& e) {
  const double all = phi.squaredNorm();
  const double theta = phi.dot(e) / all;
  // Every part's share of theta: what the record would say with that part doubled.
  const Index length = phi.size() / kPartsOfRun;
  double variance = 0.0;
  for (Index p = 0; p < kPartsOfRun; ++p) {
    const auto part = phi.segment(p * length, length);
    const double share =
        (part.dot(e.segment(p * length, length)) - theta * part.squaredNorm()) / all;
    variance += share * share;
  }
  constexpr double kSigmas = 3.0;
  return std::abs(theta) + kSigmas * std::sqrt(variance * kPartsOfRun /
                                               static_cast<double>(kPartsOfRun - 1));
}

/// A model with its gains, and what it leaves behind them.
struct Beside {
  Changes changes;
  const FilterPath& path;
  KeptGains gains;
  VectorXd left;
};

Beside BesideOf(const AnswerData& data, const ModelOnRuns& one) {
  Beside beside{
      ChangesOfModel(data.blocks, one.fit.model), one.seen, KeepGains(one.seen), {}};
  try {
    beside.left =
        PredictAlong(data.With(one.fit.model), data.run.seen, one.seen, beside.gains);
  } catch (const NumericalError&) {
    // Of a machine that diverges nothing is known.
  }
  return beside;
}

/// 0 where nothing is known.
double LimitBeside(const AnswerData& data, const Beside& beside,
                   const std::string& fault) {
  if (beside.left.size() == 0) return 0.0;
  constexpr double kStep = 1e-3;
  Changes changes = beside.changes;
  changes.faults.push_back({fault, 1.0 + kStep});
  const Machine faulty = data.machine.With(changes);
  try {
    const VectorXd moved =
        PredictAlong(data.steps.Of(faulty), data.run.seen, beside.path, beside.gains);
    return HiddenFault((beside.left - moved) / kStep, beside.left);
  } catch (const NumericalError&) {
    return 0.0;
  }
}

}  // namespace

void AddMinimumDetectableFaults(const AnswerData& data, const UnseenJudgement& judged,
                                Discovery& discovery) {
  const std::vector<FaultParameter> faults = FaultParameters(data.machine.plant());
  if (faults.empty()) return;
  std::vector<FaultLimit> limits(faults.size());
  const Beside before = BesideOf(data, judged.nothing);
  const Beside after = BesideOf(data, judged.answer);
  ParallelFor(2 * static_cast<int>(faults.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number / 2);
    const bool is_before = number % 2 == 0;
    double& limit = is_before ? limits[i].before : limits[i].after;
    limit = LimitBeside(data, is_before ? before : after, faults[i].name);
  });
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (!(limits[i].before > 0.0) || !(limits[i].after > 0.0)) continue;
    limits[i].fault = faults[i].name;
    discovery.fault_limits.push_back(std::move(limits[i]));
  }
}

}  // namespace mjdiag
