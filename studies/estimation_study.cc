// How well all faults are estimated when they are present at once: [AB383],
// section 5.5, with intervals whose coverage is counted.

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/bound_study.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

StudyTable Repeat(const LoadedPlan& loaded, const RunMaker& maker,
                  const PointRuns& point, const StudyOptions& options) {
  const StudyPlan& plan = loaded.plan;
  const Machine& machine = loaded.machine;
  const auto count = static_cast<int>(point.size());
  std::vector<TwinReading> readings(point.size());
  ParallelFor(
      count,
      [&](int i) {
        const auto run = static_cast<std::size_t>(i);
        readings[run] = Listen(machine, maker.Simulate(point[run]), plan.linear);
      },
      options.progress);

  const std::string& name_of_case =
      plan.cases[static_cast<std::size_t>(point.front().in_case)].name;
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  const VectorXd truth = DeviationsOf(machine.setup(), names, FaultsOf(point.front()));
  const VectorXd bound = FaultBoundAt(machine, maker.motions().front(), truth);
  const auto band = BinomialInterval(count, 0.95, 0.99);
  GrowingTable table(
      {"All at once: " + name_of_case + ", " + std::to_string(count) + " runs",
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
  const auto runs = static_cast<double>(count);
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

std::vector<StudyTable> AnswerTo(const AskEstimates&, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const RunPlanner planner(loaded.plan);
  const RunMaker maker(loaded);
  const std::vector<PointRuns> points = RunsByPoint(planner);
  std::vector<StudyTable> tables;
  for (std::size_t i = 0; i < points.size(); ++i) {
    tables.push_back(
        Repeat(loaded, maker, points[i], options.PartOf(i, points.size())));
  }
  return tables;
}

}  // namespace mjdiag
