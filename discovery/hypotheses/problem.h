#pragma once
// A discovery in hand: the nominal machine, the measured run and the observer that
// compares them. What screening, fit and search share. It is made once, does not
// change, and is cheap to copy and to vary: copies share the run and what has been
// found of the nominal machine along it.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/discovery/hypotheses/work.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/plant_number.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// A run beside a machine and its first order, in blocks: some thousand of them hold
/// what forces do to a machine with inertia.
struct LinearisedRun {
  Track track;
  ErrorDynamics dynamics;
};

/// A number of the plant that may be another one than the model has, exp(spread z) times
/// it, with z of mean 0 and variance 1 as far as is known beforehand.
struct DoubtedNumber {
  PlantNumber number;
  double spread = 0.0;
  /// None of the plant, but how late all its inputs act: spread z [s], z from 0 to 1.
  bool is_lateness = false;
  /// How far it may be.
  double Least() const { return is_lateness ? 0.0 : -kFarthest; }
  double Most() const { return is_lateness ? 1.0 : kFarthest; }

  /// Standard deviations from where it is expected: further away it is another machine.
  static constexpr double kFarthest = 10.0;
};

class DiscoveryProblem {
 public:
  /// @param machine  the nominal one
  /// @param skip     samples at the start of every record that count for nothing
  /// @param train    samples that a fit sees; the rest is held out
  DiscoveryProblem(Machine machine, Observer observer, MeasuredRun run,
                   Eigen::Index skip, Eigen::Index train);

  const Machine& machine() const { return machine_; }
  const Observer& observer() const { return observer_; }
  const MeasuredRun& run() const { return *run_; }
  Eigen::Index skip() const { return skip_; }
  Eigen::Index train() const { return train_; }
  /// How many of samples first .. last - 1 of every sensor were measured and count, ny;
  /// empty: all.
  Eigen::VectorXd Measured(Eigen::Index first, Eigen::Index last) const;
  /// Of all sensors together.
  double MeasuredValues(Eigen::Index first, Eigen::Index last) const;
  /// Residuals of a sensor at samples first .. last - 1 that were measured, one after the
  /// other.
  Eigen::VectorXd MeasuredOf(const Eigen::VectorXd& residual, Eigen::Index sensor,
                             Eigen::Index first, Eigen::Index last) const;
  /// Of what fits see of the longest record [s].
  double FittedDuration() const;
  double step() const { return machine_.plant().opt.timestep; }  ///< of physics [s]
  /// Numbers of the plant that are fitted with every hypothesis.
  const std::vector<DoubtedNumber>& numbers() const { return numbers_; }
  /// Whether its residuals are those of free simulation (Simulating).
  bool IsFree() const { return static_cast<bool>(free_errors_); }

  /// What is spent on it, by all copies; without a limit unless one is charged.
  const std::shared_ptr<Work>& work() const { return work_; }
  double RunWork() const;  ///< of one run [s of work]

  /// The run beside the nominal machine, with the trajectory of the joints; found when
  /// first asked for. This and what follows: NumericalError if a run diverges.
  const Track& Nominal() const&;
  Track Nominal() const&&;
  /// The run with those changes, with the trajectory of the joints.
  Track Follow(const Changes& changes) const;
  /// Innovations over their standard deviation with those changes, stacked sample by
  /// sample, (ny samples).
  Eigen::VectorXd Residual(const Changes& changes) const;
  Eigen::VectorXd Scaled(const Track& track) const;
  /// The run with those changes and its first order; of the nominal machine found when
  /// first asked for.
  std::shared_ptr<const LinearisedRun> Linearised(const Changes& changes) const;
  /// Changes with the numbers at z, which may be empty: all at 0. A number that an
  /// effect among the changes stands for (Effect::Number) is as the plant says.
  Changes WithNumbers(Changes changes, const Eigen::VectorXd& z) const;
  /// Which numbers effects among the changes stand for.
  std::vector<bool> StoodFor(const Changes& changes) const;
  /// d residual / dz at z beside those changes, (ny samples) x numbers, by differences.
  Eigen::MatrixXd NumberJacobian(const Changes& changes,
                                 const Eigen::VectorXd& z) const;
  /// The same to first order along the run, of all numbers in one pass (number_forces.h,
  /// error_dynamics.h): near enough to tell where a fit has to go, in a fraction of the
  /// time.
  Eigen::MatrixXd RoughNumberJacobian(const Changes& changes,
                                      const Eigen::VectorXd& z) const;
  /// What the joints of a track did, with what was measured beside it.
  ObservedMotion MotionOf(const Track& track) const;
  /// Speed of every joint below which dry friction holds it: a fiftieth of the sensor
  /// noise a tick, nv.
  Eigen::VectorXd StillSpeed() const;

  /// The part that fits see, all of it for the fit; made when first asked for.
  DiscoveryProblem TrainPart() const;
  /// With the same physics in that many steps a control tick. The observer, which is
  /// designed on whole ticks, stays.
  DiscoveryProblem WithSubsteps(int substeps) const;
  /// With that added to its scaled innovations: what longer steps make of a run, as far as
  /// it does not depend on what is fitted.
  DiscoveryProblem Shifted(Eigen::VectorXd shift) const;
  /// With another run of the machine behind the same observer, in the steps of the setup.
  DiscoveryProblem WithRun(MeasuredRun run) const;
  /// With its runs counted as that work.
  DiscoveryProblem Charging(std::shared_ptr<Work> work) const;
  /// With doubts about those numbers.
  DiscoveryProblem Doubting(std::vector<DoubtedNumber> numbers) const;
  /// With what a free simulation is off in the place of innovations.
  /// @param errors   measured less simulated beside changes, sensors x samples
  /// @param numbers  d residual / dz, where it is known and hardly changes; of no size: by
  ///                 differences
  DiscoveryProblem Simulating(std::function<Eigen::MatrixXd(const Changes&)> errors,
                              Eigen::MatrixXd numbers = {}) const;

 private:
  friend DiscoveryProblem Beginning(const DiscoveryProblem& problem,
                                    Eigen::Index samples);
  struct Derived;

  Machine machine_;
  Observer observer_;
  std::shared_ptr<const MeasuredRun> run_;
  Eigen::Index skip_;
  Eigen::Index train_;
  std::vector<DoubtedNumber> numbers_;
  std::function<Eigen::MatrixXd(const Changes&)> free_errors_;
  std::shared_ptr<const Eigen::VectorXd> shift_;      // none: 0
  std::shared_ptr<const Machine> in_steps_of_setup_;  // none: machine_ is
  std::shared_ptr<Work> work_ = std::make_shared<Work>();
  std::shared_ptr<Derived> derived_;
};

/// What the physics steps of a simulation are off by. Positions go on with the velocity at
/// the end of a step h, so that a force acts h / 2 before its time; a machine, which has no
/// steps, is that late beside it. What is left is of second order in h. Known beforehand as
/// h / 2.
DoubtedNumber LatenessOf(const Machine& machine);

/// The same doubts about a machine in other physics steps, which are off by another time.
std::vector<DoubtedNumber> InStepsOf(const Machine& machine,
                                     std::vector<DoubtedNumber> numbers);

/// Doubts about all numbers of a plant but the known ones, and about how late inputs act;
/// none if all are known.
std::vector<DoubtedNumber> DoubtsOf(const Machine& machine,
                                    const std::vector<PlantNumber>& known = {});

/// The problem with doubts about all numbers of its plant but the known ones, as far as
/// the record says anything of them.
DiscoveryProblem WithDoubts(const DiscoveryProblem& problem,
                            const std::vector<PlantNumber>& known);

/// Noise of the sensors from the record and from the innovations of the nominal plant,
/// whichever is lower: what moves in a record is not noise. [unit of each sensor]
Eigen::VectorXd SensorNoise(const Channels& channels, const MeasuredRun& run,
                            const Eigen::MatrixXd& innovations);

/// Ticks from one reading of the slowest sensor to the next.
Eigen::Index LongestPeriod(const MeasuredRun& run);

/// Below it errors of the model are slower than a record can tell: 25 over the duration of
/// the longest [Hz].
double SlowestBandwidth(const MeasuredRun& run);

/// @param train_share  of one record that fits see, 0 to 1; of several all
/// @param bandwidth    of the observer [Hz]; 0: 25 over the duration of the longest
DiscoveryProblem PoseProblem(const Machine& machine, MeasuredRun run,
                             double train_share, double bandwidth);
DiscoveryProblem PoseProblem(const Machine& machine, const Record& measured,
                             double train_share, double bandwidth);

/// The problem cut to the first `samples` samples, all of them for the fit.
DiscoveryProblem Beginning(const DiscoveryProblem& problem, Eigen::Index samples);
/// As much of the part that fits see as shows most of what a machine does: a quarter of a
/// long record; of several records all, for each shows something that the others do not.
DiscoveryProblem BeginningOf(const DiscoveryProblem& problem);

/// Mean square of the residuals of samples first .. last - 1 that were measured.
double MeanSquare(const DiscoveryProblem& problem, const Eigen::VectorXd& residual,
                  Eigen::Index first, Eigen::Index last);

}  // namespace mjdiag
