#include "mjdiag/discovery/answer/fault_figures.h"

#include <utility>
#include <vector>

#include "mjdiag/discovery/fault_limits.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

double LimitBeside(const AnswerData& data, const ModelOnRuns& one,
                   const std::string& fault) {
  constexpr double kStep = 1e-3;
  const KeptGains gains = KeepGains(one.seen);
  Changes changes = ChangesOf(data.blocks, one.fit.model);
  changes.faults.push_back({fault, 1.0 + kStep});
  const Machine faulty = data.machine.With(changes);
  const VectorXd moved = PredictAlong(data.steps ? faulty : faulty.WithoutSteps(),
                                      data.run.seen, one.seen, gains);
  const VectorXd left =
      PredictAlong(data.With(one.fit.model), data.run.seen, one.seen, gains);
  return HiddenFault((left - moved) / kStep, left);
}

}  // namespace

void AddFaultLimits(const AnswerData& data, const UnseenJudgement& judged,
                    Discovery& discovery) {
  const std::vector<FaultParameter> faults = FaultParameters(data.machine.plant());
  std::vector<FaultLimit> limits(faults.size());
  ParallelFor(2 * static_cast<int>(faults.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number / 2);
    const bool is_before = number % 2 == 0;
    double& limit = is_before ? limits[i].before : limits[i].after;
    try {
      limit =
          LimitBeside(data, is_before ? judged.nothing : judged.answer, faults[i].name);
    } catch (const NumericalError&) {
      limit = 0.0;  // of a machine that diverges nothing is known
    }
  });
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (!(limits[i].before > 0.0) || !(limits[i].after > 0.0)) continue;
    limits[i].fault = faults[i].name;
    discovery.fault_limits.push_back(std::move(limits[i]));
  }
}

}  // namespace mjdiag
