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
  StudyTable table{
      "All at once: [studies." + sizes.name + "], " + std::to_string(options.runs) +
          " runs",
      {"fault", "deviation", "mean estimate", "largest error [%]", "sd claimed",
       "rms error", "inside 95 % interval [%]", "99 % band [%]", "sd / bound",
       "rms error / bound"},
      {},
      {"Largest errors are shares of the deviation that is there. The bound is that of "
       "the machine with these faults, the phases of disturbances unknown."}};
  const double half = TwoSidedNormalQuantile(0.05);
  const auto runs = static_cast<double>(options.runs);
  for (Index i = 0; i < truth.size(); ++i) {
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
      inside += std::abs(error) <= half * sd ? 1 : 0;
    }
    table.rows.push_back(
        {names[static_cast<std::size_t>(i)], truth[i], mean,
         truth[i] != 0.0 ? Cell(100.0 * worst / std::abs(truth[i])) : Cell("-"),
         claimed, std::sqrt(square), 100.0 * inside / runs,
         Cell(100.0 * band.first / runs).text + " to " +
             Cell(100.0 * band.second / runs).text,
         claimed / bound[i], std::sqrt(square) / bound[i]});
  }
  return table;
}

}  // namespace

std::vector<StudyTable> EstimationStudy(const Machine& machine,
                                        const StudyOptions& options) {
  std::vector<StudyTable> tables;
  for (const char* name : {"estimation_large", "estimation_small"}) {
    tables.push_back(Repeat(machine, machine.setup().Study(name), options));
  }
  return tables;
}

}  // namespace mjdiag
