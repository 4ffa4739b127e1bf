// Machines that nobody knows exactly: the numbers of each are drawn about those of the plant,
// it is calibrated on a few healthy runs, and the twin of what was learned is asked about
// healthy runs that it has not seen, and about faults of sizes that it promises to name.

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/calibrate.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/count_cells.h"
#include "mjdiag/studies/hidden_case.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// Machines have seeds of runs that are theirs.
constexpr std::uint64_t kSeedsOfAMachine = 1000;

struct MachineOutcome {
  std::string farthest;  ///< number of the plant
  double factor = 1.0;   ///< of that
  /// Of what was learned from the truth, squared, in standard deviations, over the count of
  /// numbers: 1 on average.
  double distance = 0.0;
  bool inside = false;   ///< of the region that has them all with 95 %
  int false_alarms = 0;  ///< healthy runs in which anything is named
  int faults = 0;        ///< runs with one
  int named = 0;         ///< of them those with that name and no other
  std::vector<std::string> missed;
  double alarm = 0.0;  ///< deviation from which on the best known one is named
};

/// What one machine and the twin that has learned it go through.
class DrawnMachine {
 public:
  DrawnMachine(const AskCalibration& ask, const LoadedPlan& loaded,
               const RunMaker& maker, int place)
      : ask_(ask),
        nominal_(loaded.machine),
        maker_(maker),
        linear_(loaded.plan.linear),
        seed_(loaded.plan.seed + kSeedsOfAMachine * static_cast<std::uint64_t>(place)),
        factors_(Draw()) {}

  MachineOutcome Run() {
    std::vector<Record> healthy;
    for (int i = 0; i < ask_.learned_from; ++i) healthy.push_back(RecordWith({}));
    const Calibration learned =
        Calibrate(nominal_, healthy, {.linear = linear_, .progress = {}}).calibration;
    CompareNumbers(learned);
    const Machine calibrated = CalibratedMachine(nominal_, learned);
    TwinReading reading;
    for (int i = 0; i < ask_.judged; ++i) {
      reading = Listen(calibrated, RecordWith({}), linear_);
      if (std::ranges::count(reading.named, true) > 0) ++outcome_.false_alarms;
    }
    TryFaults(calibrated, reading.alarm);
    return outcome_;
  }

 private:
  NumberFactors Draw() const {
    Random random(seed_);
    return DrawNumbers(nominal_.plant(), random,
                       [](const mjModel&, const ModelParameter& number) {
                         return UsualSpread(number.kind);
                       });
  }

  /// Another run.
  Record RecordWith(const std::vector<DrawnAxis>& faults) {
    PlannedRun run;
    run.seed = ++seed_;
    run.axes = faults;
    run.numbers = factors_;
    return maker_.Simulate(run);
  }

  /// All together: what the record tells of their common scale is nothing, so that by
  /// itself each is off if that is.
  void CompareNumbers(const Calibration& learned) {
    Eigen::VectorXd away = learned.factors.array().log();
    double most = 0.0;
    for (const auto& [number, factor] : factors_) {
      const std::string name = ModelParameterName(nominal_.plant(), number);
      if (std::abs(std::log(factor)) > most) {
        most = std::abs(std::log(factor));
        outcome_.farthest = name;
        outcome_.factor = factor;
      }
      const auto found = std::ranges::find(learned.numbers, name);
      // A linear plant has no dry friction.
      if (found == learned.numbers.end()) continue;
      away[found - learned.numbers.begin()] -= std::log(factor);
    }
    const auto n = static_cast<double>(away.size());
    const double squares = Solve(learned.root, away).squaredNorm();
    outcome_.distance = squares / n;
    outcome_.inside = squares < ChiSquaredQuantile(1.0 - kConfidence, n);
  }

  void TryFaults(const Machine& calibrated, const Eigen::VectorXd& alarm) {
    const std::vector<std::string> names = MakeFaultFamily(nominal_).Names();
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double least = alarm[static_cast<Index>(i)];
      if (!std::isfinite(least)) continue;  // of a disturbance
      if (outcome_.faults == 0 || least < outcome_.alarm) outcome_.alarm = least;
      const double factor = 1.0 + ask_.promised * least;
      // Every second one becomes smaller.
      const double value = i % 2 == 0 ? factor : 1.0 / factor;
      PlanAxis axis;
      axis.name = names[i];
      const TwinReading reading =
          Listen(calibrated, RecordWith({{&axis, value}}), linear_);
      ++outcome_.faults;
      std::vector<bool> expected(names.size(), false);
      expected[i] = true;
      if (reading.named == expected) {
        ++outcome_.named;
      } else {
        outcome_.missed.push_back(names[i]);
      }
    }
  }

  const AskCalibration& ask_;
  const Machine& nominal_;
  const RunMaker& maker_;
  bool linear_;
  std::uint64_t seed_;
  NumberFactors factors_;
  MachineOutcome outcome_;
};

std::vector<Cell> RowOfMachine(int place, int judged, const MachineOutcome& outcome) {
  return {static_cast<double>(place + 1),
          outcome.farthest + " " + Cell(100.0 * (outcome.factor - 1.0)).text + " %",
          Cell(outcome.distance),
          CountText(outcome.false_alarms, judged),
          Cell(100.0 * outcome.alarm),
          CountText(outcome.named, outcome.faults),
          outcome.missed.empty() ? "-" : Listed(outcome.missed)};
}

StudyTable CountsOfMachines(const std::vector<MachineOutcome>& outcomes, int judged) {
  StudyTable table{"All machines",
                   {"what", "count", "[%]", "95 % interval [%]"},
                   {},
                   {"Intervals of Clopper and Pearson, as if all were independent."}};
  const auto add = [&](const std::string& what, auto count, auto of) {
    int sum = 0;
    int all = 0;
    for (const MachineOutcome& outcome : outcomes) {
      sum += count(outcome);
      all += of(outcome);
    }
    AddCount(table, what, sum, all);
  };
  add(
      "healthy runs in which a fault is named",
      [](const MachineOutcome& outcome) { return outcome.false_alarms; },
      [judged](const MachineOutcome&) { return judged; });
  add(
      "faults of a size that is promised, named with no other",
      [](const MachineOutcome& outcome) { return outcome.named; },
      [](const MachineOutcome& outcome) { return outcome.faults; });
  add(
      "numbers of a plant inside the region that has them all with 95 %",
      [](const MachineOutcome& outcome) { return outcome.inside ? 1 : 0; },
      [](const MachineOutcome&) { return 1; });
  return table;
}

}  // namespace

std::vector<StudyTable> AnswerTo(const AskCalibration& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const int machines = loaded.plan.replications;
  const RunMaker maker(loaded);
  GrowingTable table(
      {"Machines drawn at random, " + PlantName(loaded.plan.linear),
       {"machine", "farthest from the plant", "distance of the numbers", "false alarms",
        "best known from [%]", "faults named", "not named, or with another"},
       {},
       {"Each is calibrated on " + std::to_string(ask.learned_from) +
            " healthy runs and " + "judged in " + std::to_string(ask.judged) +
            " others. A fault of every kind, " + Cell(ask.promised).text +
            " times as large as the diagnosis says that it has to be, has to be named "
            "and no other beside it.",
        "The distance is that of what was learned from what was drawn, squared, in "
        "standard deviations, over the count of numbers: 1 on average.",
        "Numbers are drawn with the standard deviations that they have without "
        "measuring: masses and motor constants 1 %, inertias 3 %, mounts 5 %, damping "
        "and dry friction 20 %."}},
      options.row);
  std::vector<MachineOutcome> outcomes(static_cast<std::size_t>(machines));
  ParallelInOrder(
      machines,
      [&](int i) {
        MachineOutcome& outcome = outcomes[static_cast<std::size_t>(i)];
        outcome = DrawnMachine(ask, loaded, maker, i).Run();
        table.Put(static_cast<std::size_t>(i), RowOfMachine(i, ask.judged, outcome));
      },
      options.progress);
  return {table.table(), CountsOfMachines(outcomes, ask.judged)};
}

}  // namespace mjdiag
