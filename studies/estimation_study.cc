#include "mjdiag/studies/estimation_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/bound_study.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Deviations that are there, in the order of the design's faults.
VectorXd Truth(const Setup& setup, const DiagnosisDesign& design,
               const FaultSizes& sizes) {
  VectorXd truth = VectorXd::Zero(design.faults());
  const std::vector<std::string> names = design.FaultNames();
  for (const auto& [name, value] : sizes.values) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) continue;  // WithFaults says so
    truth[found - names.begin()] = value - HealthyValue(setup, name);
  }
  return truth;
}

StudyTable Repeat(const Machine& machine, const DiagnosisDesign& design,
                  const FaultSizes& sizes, const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  std::vector<SizedFault> faults;
  for (const auto& [name, value] : sizes.values) faults.push_back({name, value});

  std::vector<FaultEstimate> estimates(static_cast<std::size_t>(options.runs));
  ParallelFor(
      options.runs,
      [&](int i) {
        const Record record = RunLinear(
            motion,
            WithFaults(machine, faults, options.seed + static_cast<std::uint64_t>(i)));
        estimates[static_cast<std::size_t>(i)] =
            RefineFaults(machine, design, record).estimate;
      },
      options.progress);

  const VectorXd truth = Truth(machine.setup(), design, sizes);
  const InformationBound bound = FaultBound(machine, motion);
  const auto band = BinomialInterval(options.runs, 0.95, 0.99);
  StudyTable table{
      "All at once: [studies." + sizes.name + "], " + std::to_string(options.runs) +
          " runs",
      {"fault", "deviation", "mean estimate", "largest error [%]", "sd claimed",
       "sd found", "inside 95 % interval [%]", "99 % band [%]", "times bound"},
      {},
      {"Errors are shares of the deviation that is there. The bound is that "
       "of the healthy machine."}};
  const std::vector<std::string> names = design.FaultNames();
  const double half = TwoSidedNormalQuantile(0.05);
  const auto runs = static_cast<double>(options.runs);
  for (Index i = 0; i < truth.size(); ++i) {
    double mean = 0.0;
    double square = 0.0;
    double claimed = 0.0;
    double worst = 0.0;
    int inside = 0;
    for (const FaultEstimate& estimate : estimates) {
      const double error = estimate.value[i] - truth[i];
      const double sd = std::sqrt(estimate.covariance(i, i));
      mean += estimate.value[i] / runs;
      square += error * error / runs;
      claimed += sd / runs;
      worst = std::max(worst, std::abs(error));
      inside += std::abs(error) <= half * sd ? 1 : 0;
    }
    table.rows.push_back(
        {names[static_cast<std::size_t>(i)], truth[i], mean,
         truth[i] != 0.0 ? Cell(100.0 * worst / std::abs(truth[i])) : Cell("-"),
         claimed, std::sqrt(square), 100.0 * inside / runs,
         Cell(100.0 * band.first / runs).text + " to " +
             Cell(100.0 * band.second / runs).text,
         claimed / bound.together[i]});
  }
  return table;
}

}  // namespace

std::vector<StudyTable> EstimationStudy(const Machine& machine,
                                        const StudyOptions& options) {
  const DiagnosisDesign design = DesignFilters(machine);
  std::vector<StudyTable> tables;
  for (const char* name : {"estimation_large", "estimation_small"}) {
    tables.push_back(Repeat(machine, design, machine.setup().Study(name), options));
  }
  return tables;
}

}  // namespace mjdiag
