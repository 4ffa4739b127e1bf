#pragma once
// The diagnosis of a running machine: a monitor with its twin (mjdiag/diagnosis/monitor.h)
// that is fed with ticks in their order, and looked at a few times a second.
//
// What it does about what is missing:
//   a reading         it is bridged by the one before; the twin does without it, and the
//                     residual is not judged till its filters have forgotten it: to
//                     encoders a tick in motion is far from nothing
//   a command, a tick nobody knows what drove the machine, and the error that any guess
//                     leaves stays with the twin for good: another run begins, in which
//                     monitor, twin and filters begin anew, in motion. What was said
//                     stands till the new run has something to say
//
// A twin that begins in motion has to guess how the machine moved, and mistakes now and
// then what is left of the guess for a small fault. What such a run names in its first
// seconds while the residual is within its limits has to be named by another run, too,
// which begins then.
//
// And now and then a twin does not find its machine again after a change: then another run
// begins, too.
//
// Tones and noise are looked for in stretches of the disturbance residual, one after the
// other; a tone counts, and noise is raised, that two of them in a row show: one in
// ten thousand stretches shows one by chance, and a day has tens of thousands. A stretch
// in which something was bridged is none.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/watch/judge/finding.h"
#include "mjdiag/watch/stream/tick_order.h"

namespace mjdiag {

/// A twin that does not know its machine any more for so long begins anew [s].
inline constexpr double kLost = 3.0;

struct JudgeOptions {
  double look = 0.1;     ///< [s] between looks
  double stretch = 2.0;  ///< [s] in which tones are looked for; four segments at least
  double settle = 2.0;   ///< [s] of a run before it says anything
};

class TickJudge final : public OrderedSink {
 public:
  /// @param prepared  outlives it, as the machine
  /// @param on_look   called at every look, from within OnTick
  TickJudge(const Machine& machine, const PreparedDiagnosis& prepared,
            const JudgeOptions& options, std::function<void(const Finding&)> on_look);

  void OnNewRun() override;
  void OnMissing(std::int64_t ticks) override;
  void OnTick(const TickHead& head, std::span<const double> values) override;

  const DiagnosisDesign& design() const { return prepared_.design; }
  std::int64_t runs() const { return runs_; }  ///< of the diagnosis

 private:
  void Begin(std::span<const double> values);
  void Feed(std::span<const double> values);
  void AfterTick(double arrived);
  void BeginStretch();
  void AnalyseStretchOfRun();
  void LookAt(double time);
  bool HasLostTheMachine(double run_time);
  bool WantsAnotherOpinion(const Finding& look);

  const Machine& machine_;
  const PreparedDiagnosis& prepared_;
  JudgeOptions options_;
  std::function<void(const Finding&)> on_look_;
  Eigen::Index look_ticks_;
  Eigen::Index stretch_ticks_;
  Eigen::Index skipped_ticks_;  // of a stretch, in which filters settle
  std::unique_ptr<DiagnosisRecording> recording_;
  std::vector<double> last_;  // values that were fed
  std::unique_ptr<bool[]> measured_;
  std::int64_t missing_ = 0;  // ticks since the last look
  std::int64_t runs_ = 0;
  Eigen::Index since_look_ = 0;
  Stretch residual_;
  bool alarm_ = false;
  std::optional<DisturbanceReport> stretch_before_;
  DisturbanceReport disturbance_;
  bool analysed_ = false;
  bool in_motion_ = false;             // when the run began
  bool confirmed_ = false;             // what it names, by the run before
  std::vector<std::string> suspects_;  // that such a run has named
  double known_ = 0.0;  // when the twin last knew its machine, since the run began [s]
  double lost_patience_ = kLost;
  double last_alarm_ = 0.0;  // since the run began [s]
  bool any_alarm_ = false;
};

}  // namespace mjdiag
