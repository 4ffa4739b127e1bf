// One long run: the machine repeats its default motion for hours, with the diagnosis and
// its twin in the control callback, and nothing is kept of it but a row now and then. A
// healthy machine must not be named faulty, what wears evenly must be followed, and
// neither memory nor the time of a tick may grow.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/runtime/running_machine.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Clock = std::chrono::steady_clock;

/// Between two looks at what the twin says [s].
constexpr double kLook = 0.1;
/// In which a wear is even [s]: at a percent an hour the chord of a stiffness is a part
/// in 1e10 off.
constexpr double kChord = 10.0;

/// What this process has in memory [MB], NaN where /proc does not say.
double ResidentMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == "VmRSS:" && status >> kilobytes) return 1e-3 * kilobytes;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double Seconds(Clock::time_point from) {
  return std::chrono::duration<double>(Clock::now() - from).count();
}

class Watcher final : public TickObserver {
 public:
  Watcher(const Machine& machine, bool linear)
      : monitor_(DiagnosisOn(machine, linear).design) {
    auto twin = MakeTwinEstimator(machine, linear);
    if (!twin) {
      throw InputError("setup '" + machine.setup().name + "'",
                       "has nothing to estimate",
                       "fault parameters and noise on its sensors");
    }
    monitor_.Follow(std::move(twin));
  }

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override {
    monitor_.Add(outputs, inputs);
    alarms_ += monitor_.residual_alarm() ? 1 : 0;
  }

  const TwinEstimator& twin() const { return *monitor_.twin(); }
  /// Ticks with the residual outside its limits since asked.
  Index TakeAlarms() { return std::exchange(alarms_, 0); }

 private:
  DiagnosisMonitor monitor_;
  Index alarms_ = 0;
};

/// The truth of a machine that wears.
class Wear {
 public:
  Wear(const Machine& machine,
       const std::vector<std::pair<std::string, double>>& an_hour)
      : machine_(machine) {
    for (const auto& [name, growth] : an_hour) an_hour_.push_back({name, growth});
    At(kChord);  // complains of names and values
  }

  std::vector<SizedFault> ValuesAt(double time) const {
    std::vector<SizedFault> values = an_hour_;
    for (SizedFault& fault : values) fault.value = 1.0 + fault.value * time / 3600.0;
    return values;
  }
  Machine At(double time) const {
    Changes changes;
    for (const auto& [name, value] : ValuesAt(time)) {
      changes.faults.push_back({name, value});
    }
    return machine_.With(changes);
  }
  bool any() const { return !an_hour_.empty(); }

 private:
  Machine machine_;
  std::vector<SizedFault> an_hour_;
};

/// What was seen since the last row, or of the whole run.
struct Seen {
  Index looks = 0;
  Index named_looks = 0;  ///< in which anything was named
  Index false_looks = 0;  ///< in which a fault was named that is not there
  double nis = 0.0;       ///< largest
  VectorXd squares;       ///< of errors over their standard deviation
  VectorXd largest;       ///< of them, by size
  std::set<std::size_t> named;

  explicit Seen(Index faults)
      : squares(VectorXd::Zero(faults)), largest(VectorXd::Zero(faults)) {}

  void Add(const TwinReading& reading, const VectorXd& truth) {
    ++looks;
    nis = std::max(nis, reading.nis);
    bool any = false;
    bool wrong = false;
    for (Index i = 0; i < truth.size(); ++i) {
      const auto fault = static_cast<std::size_t>(i);
      const double error = (reading.deviation[i] - truth[i]) / reading.sd[i];
      squares[i] += error * error;
      largest[i] = std::max(largest[i], std::abs(error));
      if (!reading.named[fault]) continue;
      any = true;
      wrong = wrong || truth[i] == 0.0;
      named.insert(fault);
    }
    named_looks += any ? 1 : 0;
    false_looks += wrong ? 1 : 0;
  }
};

std::string NamesOf(const std::set<std::size_t>& faults,
                    const std::vector<std::string>& names) {
  std::string text;
  for (const std::size_t fault : faults) {
    text += (text.empty() ? "" : ", ") + names[fault];
  }
  return text.empty() ? "-" : text;
}

StudyTable EmptyRows(const LoadedPlan& loaded, const std::vector<std::string>& names) {
  StudyTable table{
      "Endurance of " + loaded.machine.setup().name + ", " +
          PlantName(loaded.plan.linear),
      {"time [s]", "named", "looks", "with names", "false", "alarms [ticks]",
       "since [s]", "passes", "NIS", "error / sd", "memory [MB]", "wall [s/s]"},
      {},
      {"Looks, names, alarms of the residual, the largest NIS and the largest "
       "error over its standard deviation are those since the row before; estimates "
       "(deviations from healthy) and their standard deviations are those at its "
       "end."}};
  for (const std::string& name : names) {
    table.columns.push_back(name);
    table.columns.push_back("sd " + name);
  }
  return table;
}

class LongRun {
 public:
  LongRun(const AskEndurance& ask, const LoadedPlan& loaded,
          const StudyOptions& options)
      : ask_(ask),
        machine_(loaded.machine),
        options_(options),
        names_(MakeFaultFamily(machine_).Names()),
        wear_(machine_, ask.wear),
        watcher_(machine_, loaded.plan.linear),
        whole_(static_cast<Index>(names_.size())),
        recent_(whole_),
        rows_(EmptyRows(loaded, names_), options.row) {
    RunOptions run;
    run.seed = loaded.plan.seed;
    run.repeat = true;
    run.observer = &watcher_;
    const RunMaker maker(loaded);
    const Excitation& motion = maker.motions().front();
    running_ = loaded.plan.linear ? StartLinear(machine_, motion, run)
                                  : StartNonlinear(machine_, motion, run);
  }

  std::vector<StudyTable> Run() {
    const Index ticks = TicksOf(ask_.duration);
    const Index look = TicksOf(kLook);
    const Index row = std::max(look, TicksOf(ask_.every) / look * look);
    const Index chord = TicksOf(kChord);
    memory_ = ResidentMemory();
    row_start_ = Clock::now();
    for (Index tick = 0; tick < ticks; ++tick) {
      if (wear_.any() && tick % chord == 0) {
        running_->Become(wear_.At(TimeOf(tick + chord)), chord);
      }
      running_->Tick();
      const Index done = tick + 1;
      if (done % look == 0) Look(TimeOf(done));
      if (done % row == 0 || done == ticks) AddRow(done);
      if (options_.progress && done % look == 0) {
        options_.progress(static_cast<double>(done) / static_cast<double>(ticks));
      }
    }
    return {rows_.table(), Summary(), Errors()};
  }

 private:
  Index TicksOf(double time) const {
    return std::max<Index>(1, std::llround(time / machine_.rates().tick()));
  }
  double TimeOf(Index tick) const {
    return static_cast<double>(tick) * machine_.rates().tick();
  }

  void Look(double time) {
    if (!watcher_.twin().estimator().began()) return;
    reading_ = watcher_.twin().Read();
    const VectorXd truth = DeviationsOf(machine_.setup(), names_, wear_.ValuesAt(time));
    whole_.Add(reading_, truth);
    recent_.Add(reading_, truth);
  }

  void AddRow(Index done) {
    const PredictionErrorEstimator& estimator = watcher_.twin().estimator();
    const double seconds = Seconds(row_start_);
    row_start_ = Clock::now();
    wall_ += seconds;
    const Index alarms = watcher_.TakeAlarms();
    alarms_ += alarms;
    std::vector<Cell> row = {Cell(TimeOf(done)),
                             NamesOf(recent_.named, names_),
                             Cell(static_cast<double>(recent_.looks)),
                             Cell(static_cast<double>(recent_.named_looks)),
                             Cell(static_cast<double>(recent_.false_looks)),
                             Cell(static_cast<double>(alarms)),
                             Cell(TimeOf(estimator.since())),
                             Cell(static_cast<double>(estimator.returns())),
                             Cell(recent_.nis),
                             Cell(recent_.largest.maxCoeff()),
                             Cell(ResidentMemory()),
                             Cell(seconds / TimeOf(done - row_end_))};
    for (Index i = 0; i < reading_.deviation.size(); ++i) {
      row.emplace_back(reading_.deviation[i]);
      row.emplace_back(reading_.sd[i]);
    }
    row_end_ = done;
    recent_ = Seen(whole_.squares.size());
    rows_.Add(std::move(row));
  }

  StudyTable Summary() const {
    const auto count = [](Index n) { return Cell(static_cast<double>(n)); };
    return {"The whole run",
            {"figure", "value"},
            {{"simulated [s]", Cell(TimeOf(row_end_))},
             {"looks", count(whole_.looks)},
             {"looks with a name", count(whole_.named_looks)},
             {"looks with a false name", count(whole_.false_looks)},
             {"ticks with an alarm of the residual", count(alarms_)},
             {"largest NIS", Cell(whole_.nis)},
             {"memory at the start [MB]", Cell(memory_)},
             {"memory at the end [MB]", Cell(ResidentMemory())},
             {"wall time a simulated second [s]", Cell(wall_ / TimeOf(row_end_))}},
            {}};
  }

  StudyTable Errors() const {
    StudyTable table{"Errors over standard deviations claimed",
                     {"fault", "rms", "largest"},
                     {},
                     {"Of all looks."}};
    for (std::size_t k = 0; k < names_.size(); ++k) {
      const auto i = static_cast<Index>(k);
      const auto looks = static_cast<double>(whole_.looks);
      table.rows.push_back({names_[k], Cell(std::sqrt(whole_.squares[i] / looks)),
                            Cell(whole_.largest[i])});
    }
    return table;
  }

  const AskEndurance& ask_;
  const Machine& machine_;
  const StudyOptions& options_;
  std::vector<std::string> names_;
  Wear wear_;
  Watcher watcher_;
  Seen whole_, recent_;
  GrowingTable rows_;
  std::unique_ptr<RunningMachine> running_;
  TwinReading reading_;
  Clock::time_point row_start_;
  Index row_end_ = 0;
  Index alarms_ = 0;
  double wall_ = 0.0;
  double memory_ = 0.0;
};

}  // namespace

std::vector<StudyTable> AnswerTo(const AskEndurance& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  for (const auto& [name, growth] : ask.wear) {
    if (!IsDisturbance(loaded.machine.setup(), name)) continue;
    throw InputError("wear of " + name, "it is a disturbance",
                     "a fault parameter of the plant");
  }
  return LongRun(ask, loaded, options).Run();
}

}  // namespace mjdiag
