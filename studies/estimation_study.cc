#include "mjdiag/studies/estimation_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/bound_study.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

StudyTable Repeat(const Machine& machine, const FaultSizes& sizes,
                  const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  std::vector<SizedFault> faults;
  for (const auto& [name, value] : sizes.values) faults.push_back({name, value});

  std::vector<TwinReading> readings(static_cast<std::size_t>(options.runs));
  ParallelFor(
      options.runs,
      [&](int i) {
        const Record record = RunLinear(
            motion,
            WithFaults(machine, faults, options.seed + static_cast<std::uint64_t>(i)));
        readings[static_cast<std::size_t>(i)] = Listen(machine, record, true);
      },
      options.progress);

  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  const VectorXd truth = DeviationsOf(machine.setup(), names, faults);
  const VectorXd bound = FaultBoundAt(machine, motion, truth);
  const auto band = BinomialInterval(options.runs, 0.95, 0.99);
  GrowingTable table(
      {"All at once: " + sizes.name + ", " + std::to_string(options.runs) + " runs",
       {"fault", "deviation", "mean estimate", "largest error [%]", "sd claimed",
        "rms error", "inside 95 % interval [%]", "99 % band [%]", "sd / bound",
        "rms error / bound"},
       {},
       {"Largest errors are shares of the deviation that is there. The bound is that "
        "of "
        "the machine with these faults, the phases of disturbances unknown.",
        "The interval of a magnitude, which is not below 0, is that of a noncentral "
        "chi-squared variable, and where that would be short by luck that of noise "
        "alone "
        "(diagnosis/statistics/magnitude_interval.h): it may hold more than 95 %."}},
      options.row);
  const auto runs = static_cast<double>(options.runs);
  for (Index i = 0; i < truth.size(); ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    double mean = 0.0;
    double square = 0.0;
    double claimed = 0.0;
    double worst = 0.0;
    int inside = 0;
    for (const TwinReading& reading : readings) {
      const double error = reading.deviation[i] - truth[i];
      const double sd = reading.sd[i];
      mean += reading.deviation[i] / runs;
      square += error * error / runs;
      claimed += sd / runs;
      worst = std::max(worst, std::abs(error));
      const Interval& ci95 = reading.ci95[static_cast<std::size_t>(i)];
      inside += truth[i] >= ci95.min && truth[i] <= ci95.max ? 1 : 0;
    }
    table.Add({name, truth[i], mean,
               truth[i] != 0.0 ? Cell(100.0 * worst / std::abs(truth[i])) : Cell("-"),
               claimed, std::sqrt(square), 100.0 * inside / runs,
               Cell(100.0 * band.first / runs).text + " to " +
                   Cell(100.0 * band.second / runs).text,
               claimed / bound[i], std::sqrt(square) / bound[i]});
  }
  return table.table();
}

}  // namespace

std::vector<StudyTable> EstimationStudy(const Machine& machine,
                                        const StudyOptions& options) {
  const std::vector<FaultSizes> cases = {machine.setup().Study("estimation_large"),
                                         machine.setup().Study("estimation_small"),
                                         machine.setup().Study("estimation_faint"),
                                         {"healthy", {}}};
  std::vector<StudyTable> tables;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    StudyOptions part = options;
    part.progress = [&, i](double fraction) {
      if (!options.progress) return;
      options.progress((static_cast<double>(i) + fraction) /
                       static_cast<double>(cases.size()));
    };
    tables.push_back(Repeat(machine, cases[i], part));
  }
  return tables;
}

}  // namespace mjdiag
