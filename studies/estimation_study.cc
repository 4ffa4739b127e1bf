#include "mjdiag/studies/estimation_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/bound_study.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Deviations that are there, in the order of the faults.
VectorXd Truth(const Setup& setup, const std::vector<std::string>& names,
               const FaultSizes& sizes) {
  VectorXd truth = VectorXd::Zero(static_cast<Index>(names.size()));
  for (const auto& [name, value] : sizes.values) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) continue;  // WithFaults says so
    truth[found - names.begin()] = value - HealthyValue(setup, name);
  }
  return truth;
}

/// What a twin says that has listened to the whole record.
TwinReading Listen(const Machine& machine, const Record& record) {
  const std::unique_ptr<TwinEstimator> twin = MakeTwinEstimator(machine, true);
  const MatrixXd y = SamplesOf(record, ChannelsOf(machine.channels().sensors));
  const MatrixXd u = SamplesOf(record, ChannelsOf(machine.channels().actuators));
  for (Index k = 0; k < y.cols(); ++k) {
    twin->Add({y.col(k).data(), static_cast<std::size_t>(y.rows())},
              {u.col(k).data(), static_cast<std::size_t>(u.rows())});
  }
  twin->CatchUp();
  return twin->Read();
}

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
        readings[static_cast<std::size_t>(i)] = Listen(machine, record);
      },
      options.progress);

  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  const VectorXd truth = Truth(machine.setup(), names, sizes);
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
