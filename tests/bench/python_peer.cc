// The half in C++ of what is compared with Python: scripts/bench times SciPy and the
// Python package in its own process and tells this one, line by line, when its turn is, so
// that both meet the same in short slices. A line is a task, the answer a line of JSON:
//
//   bank            the filters and signals of `filter`, and the last outputs
//   filter          processor seconds of the filters over all signals
//   simulate        of a run of the bonder
//   monitor <n>     of the next n ticks of a diagnosis of that machine, taken as linear
//
// Seconds are those of this process, as Python's time.process_time.

#include <Eigen/Core>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>

#include "bench/timing.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using nlohmann::json;

json Rows(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (const auto& row : matrix.rowwise()) {
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

class Peer {
 public:
  double Simulate() {
    return Seconds(ProcessTime, [&] { mjdiag::Simulate(machine_, motion_, {}); });
  }

  /// The prefilters of the disturbance residual: their poles at 750 Hz leave a filter
  /// in powers of z, as lfilter is one, its digits. Those at 50 Hz do not.
  json Bank() {
    const DiagnosisDesign design = DesignFilters(machine_);
    bank_ = design.disturbance.prefilters;
    signals_ = Signals(design, LinearRun(machine_));
    const Eigen::MatrixXd outputs = FilterSignals(bank_, signals_);
    return {
        {"gain", bank_.gain},
        {"feedback", std::vector<double>(bank_.feedback.begin(), bank_.feedback.end())},
        {"B", Rows(bank_.B)},
        {"D", Rows(bank_.D)},
        {"signals", Rows(signals_)},
        {"outputs", Rows(outputs.rightCols(1))}};
  }
  double Filter() {
    Eigen::MatrixXd outputs;
    return Seconds(ProcessTime, [&] { outputs = FilterSignals(bank_, signals_); });
  }

  double Monitor(Eigen::Index ticks) {
    if (!recording_) Watch();
    return Seconds(ProcessTime, [&] {
      for (Eigen::Index i = 0; i < ticks; ++i) {
        const Eigen::Index k = tick_++ % outputs_.cols();
        recording_->Add(Column(outputs_, k), Column(inputs_, k));
      }
    });
  }

 private:
  static std::span<const double> Column(const Eigen::MatrixXd& samples,
                                        Eigen::Index k) {
    return {samples.col(k).data(), static_cast<std::size_t>(samples.rows())};
  }
  void Watch() {
    DiagnosisSource source;
    source.nominal.linear = true;
    const PreparedDiagnosis prepared = PrepareDiagnosis(machine_, source);
    const Record run = SimulateLinear(machine_, DefaultMotion(machine_.setup()), {});
    outputs_ = SamplesOf(run, prepared.design.outputs);
    inputs_ = SamplesOf(run, prepared.design.inputs);
    recording_.emplace(BeginDiagnosis(machine_, prepared, run.samples()));
  }

  Machine machine_ = test::Bonder();
  Excitation motion_ = FollowTrajectory(machine_.setup(), [this] {
    Trajectory motion = machine_.setup().trajectories.Find("multi");
    motion.duration = 0.125;
    return motion;
  }());
  FilterBank bank_;
  Eigen::MatrixXd signals_;
  std::optional<DiagnosisRecording> recording_;
  Eigen::MatrixXd outputs_, inputs_;
  Eigen::Index tick_ = 0;
};

json Answer(Peer& peer, const std::string& line) {
  std::istringstream words(line);
  std::string task;
  Eigen::Index ticks = 0;
  words >> task >> ticks;
  if (task == "bank") return peer.Bank();
  if (task == "filter") return peer.Filter();
  if (task == "simulate") return peer.Simulate();
  if (task == "monitor") return peer.Monitor(ticks);
  throw std::invalid_argument("no task '" + line + "'");
}

}  // namespace
}  // namespace mjdiag

// What it throws ends it, with its text.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main() {
  mjdiag::Peer peer;
  for (std::string line; std::getline(std::cin, line);) {
    std::cout << mjdiag::Answer(peer, line) << std::endl;
  }
}
