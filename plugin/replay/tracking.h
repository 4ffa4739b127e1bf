#pragma once
// Replay of a measured input on the nonlinear plant beside an observer (observer.h).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/error_dynamics.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// Where dry friction in the joints is the only constraint there are as many unknown
/// forces as joints that rub, next to uncoupled, and projected Gauss-Seidel finds them
/// in a few sweeps, closer than Newton's default tolerance and in half of its time.
void ChooseSolver(mjModel& model);

/// Where a record begins.
struct RecordStart {
  Eigen::Index sample = 0;
  std::map<std::string, double> readings{};  ///< at rest before its first sample
  /// As it was during the record, with another load for example; none: that of the run.
  std::shared_ptr<const Machine> machine{};
  /// Ticks that its clock has run before: what goes with time goes on.
  Eigen::Index ticks_before = 0;
};

/// A machine as it was during a record.
Machine DuringRecord(const RecordStart& record, const Machine& machine);
std::vector<Machine> DuringRecord(const RecordStart& record,
                                  const std::vector<Machine>& machines);

/// What of measured records the replay needs, in the setup's order: one after the other,
/// each from its own start.
struct MeasuredRun {
  double sample_time = 0.0;  ///< [s]
  Eigen::MatrixXd outputs;   ///< sensors x samples
  Eigen::MatrixXd inputs;    ///< actuators x samples
  /// Of a run that is looked at once in some ticks (coarser_run.h), those of every tick, whose
  /// means `inputs` are then: actuators x ticks x samples; empty: they are the inputs.
  Eigen::MatrixXd finer_inputs{};
  /// Actuators x samples, 0: an open circuit; empty: all on.
  Eigen::MatrixXd on{};
  /// Which outputs were measured, sensors x samples; empty: all. Where one was not, the
  /// machine runs on without it: its innovation is 0 and counts for nothing.
  Eigen::ArrayXX<bool> measured{};
  /// Ticks whose inputs were measured, or bridge one that was not; empty: all.
  SampleMask driven{};
  /// Which outputs count: as `measured`, but for those behind inputs that are a guess.
  /// Empty: as `measured`. What does not count has innovation 0, too.
  Eigen::ArrayXX<bool> counted{};
  std::vector<RecordStart> records{{}};  ///< in order, the first at sample 0

  Eigen::Index samples() const { return outputs.cols(); }
  /// Ticks of a sample.
  Eigen::Index ticks() const {
    return finer_inputs.size() > 0 ? finer_inputs.cols() / samples() : 1;
  }
  /// Of every tick.
  const Eigen::MatrixXd& EveryInput() const {
    return ticks() > 1 ? finer_inputs : inputs;
  }
  /// Of a record.
  Eigen::Index SamplesOf(std::size_t record) const;
  /// Which record a sample is of.
  std::size_t RecordOf(Eigen::Index sample) const;
  /// Ticks of the clock of its record before a sample.
  Eigen::Index TickOf(Eigen::Index sample) const;
  /// [s] since the start of the record of every sample.
  Eigen::VectorXd Time() const;
  /// Leaves what comes behind inputs that are a guess out of what counts, so many samples
  /// of it.
  void Discount(Eigen::Index samples);
  /// `counted`, or `measured`.
  const Eigen::ArrayXX<bool>& Counted() const {
    return counted.size() > 0 ? counted : measured;
  }
  /// Which of samples first .. first + count - 1 of a sensor count.
  SampleMask CountedOf(Eigen::Index sensor, Eigen::Index first,
                       Eigen::Index count) const;
  /// Readings of a sensor that were measured, one after the other.
  Eigen::VectorXd ReadingsOf(Eigen::Index sensor) const;
  /// Ticks from one reading of a sensor to the next, usually: 1 but for sensors that are
  /// slower than the control.
  Eigen::Index PeriodOf(Eigen::Index sensor) const;
};

/// Some samples of a run, from the start of a record on.
MeasuredRun Part(const MeasuredRun& run, std::size_t record, Eigen::Index samples);
/// Some samples of a run, of one record, as a record of its own that begins in motion.
MeasuredRun Excerpt(const MeasuredRun& run, Eigen::Index first, Eigen::Index samples);
/// All of them, one after the other. Of the same channels and sample time.
MeasuredRun Joined(const std::vector<MeasuredRun>& runs);

/// InputError names a sensor or actuator channel that the record lacks, a wrong unit,
/// or a sample time that is not the control tick.
MeasuredRun ToMeasuredRun(const Setup& setup, const Record& measured);

struct InnovationSequence {
  Eigen::MatrixXd innovations;  ///< sensors x samples [unit of the sensor]
  Eigen::MatrixXd position;     ///< nv x samples, empty unless asked for
  Eigen::MatrixXd velocity;     ///< nv x samples, the same
  /// Mean over the tick of what the machine itself does, without the observer's pull,
  /// nv x samples, the same.
  Eigen::MatrixXd acceleration;
};

/// The run beside the machine with those changes; its records side by side.
/// @param machine  the nominal one
/// @param states   whether to keep the trajectory of the joints
/// NumericalError if the run diverges.
InnovationSequence RunPredictor(const Machine& machine, const Changes& changes,
                                const MeasuredRun& run, const Observer& observer,
                                bool states);

/// The same, and the first order of it.
/// @param dynamics  every tick is added to it
InnovationSequence RunPredictor(const Machine& machine, const Changes& changes,
                                const MeasuredRun& run, const Observer& observer,
                                ErrorDynamics& dynamics);

/// The inputs of a run; that of an actuator that is off is that of an open circuit, so that
/// the force of every motor is the same function of input and motion at all times.
/// @param position  nq x samples
/// @param velocity  nv x samples
Eigen::MatrixXd InputsThatAct(const Machine& machine, const MeasuredRun& run,
                              const Eigen::MatrixXd& position,
                              const Eigen::MatrixXd& velocity);

/// The motion that the joints of a track made, with what was measured beside it.
ObservedMotion ObserveMotion(const Machine& machine, const MeasuredRun& run,
                             const InnovationSequence& track);

}  // namespace mjdiag
