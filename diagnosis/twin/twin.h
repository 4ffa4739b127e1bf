#pragma once
// The model that runs beside a machine: it gets the same commands, predicts the
// readings, and knows how its predictions change with each unknown,
//
//   x[k+1] = f(x[k], u[k]; theta) + L e[k],    yp[k] = h(x[k]),    e[k] = y[k] - yp[k]
//   S[k] = d x[k] / d theta
//
// theta: whatever is not known of the machine (Unknown). L is a constant gain that
// pulls the model towards the readings: 0 where the model is trusted, else that of the
// Kalman predictor for a force noise that stands for what it does not know, of which e
// is the white innovation then. S has the gain in it. Sensitivities are those of every
// tick, given a block of ticks at a time, which costs less. No means will do: in a closed
// loop noise moves the commands, and these what the rest of a block is sensitive to, so
// that the mean of the sensitivities goes with that of the innovations.
//
// [Ljung83] L. Ljung, T. Soderstrom, "Theory and Practice of Recursive Identification",
// MIT Press, 1983, chapter 3.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/twin/running_tones.h"
#include "mjdiag/diagnosis/twin/unknown.h"

namespace mjdiag {

/// A gain with what the innovations of the true machine are then.
struct TwinGain {
  Eigen::MatrixXd L;           ///< nx x ny
  Eigen::MatrixXd covariance;  ///< of e, ny x ny
  Eigen::Index settling = 0;   ///< ticks until it has forgotten how the twin began
  Eigen::MatrixXd P = {};      ///< of the error of the state if L pulls, nx x nx
};

/// How large a twin is.
struct TwinShape {
  Eigen::Index outputs = 0;  ///< ny
  Eigen::Index inputs = 0;   ///< nu
  Eigen::Index states = 0;   ///< nx
  /// p: factors of the machine, two of every tone, then those of the start.
  Eigen::Index unknowns = 0;
  /// Of the state at the start of the run, in standard deviations of it.
  Eigen::Index start_unknowns = 0;
  Eigen::Index block = 1;  ///< d, ticks
  /// How many times faster than a factor what it does to the readings may change: a
  /// resonance gets out of step in as many of its periods as its stiffness changes by
  /// parts, a joint that sticks comes loose at another tick at once.
  double curvature = 1.0;
  /// Whether it answers to where it starts exactly linearly: any start serves to find
  /// the right one from. Else one that is nearly right is needed.
  bool linear = true;
};

/// The state of a twin at a tick of its run, to start it from again, about any theta: it
/// goes with theta as it did in the run that it comes from.
struct TwinState {
  Eigen::VectorXd x;      ///< nx
  Eigen::VectorXd theta;  ///< of that run, p
  Eigen::MatrixXd S;      ///< d x / d theta, nx x p; 0 if it was measured
};

/// Those that wear, as logarithms of numbers.
std::vector<Eigen::Index> DriftingOf(const std::vector<Unknown>& unknowns);

class Twin {
 public:
  virtual ~Twin() = default;

  Eigen::Index outputs() const { return shape_.outputs; }
  Eigen::Index states() const { return shape_.states; }
  Eigen::Index inputs() const { return shape_.inputs; }
  Eigen::Index unknowns() const { return shape_.unknowns; }
  Eigen::Index start_unknowns() const { return shape_.start_unknowns; }
  Eigen::Index block() const { return shape_.block; }
  double curvature() const { return shape_.curvature; }
  bool linear() const { return shape_.linear; }
  /// The first of those of tones.
  Eigen::Index first_tone() const {
    return unknowns() - start_unknowns() - 2 * tones_.count();
  }
  /// From that of the force noise that is assumed to ever stiffer ones; at least one.
  const std::vector<TwinGain>& gains() const { return gains_; }

  virtual TwinState MakeState() const {
    return {Eigen::VectorXd::Zero(states()), Eigen::VectorXd::Zero(unknowns()),
            Eigen::MatrixXd::Zero(states(), unknowns())};
  }

  // Nothing below allocates, locks, throws or does I/O.

  /// Before Start or between blocks.
  virtual void UseGain(std::size_t gain) noexcept = 0;
  /// To the start of a run at rest. What theta says of the start is left out of account.
  /// @param theta  p
  virtual void Start(const Eigen::VectorXd& theta) noexcept = 0;
  /// To that tick of a run in motion, in that state and what theta says beside it.
  /// @param tick   tones have phase 0 at tick 0
  virtual void Start(const Eigen::VectorXd& theta, const TwinState& state,
                     Eigen::Index tick) noexcept = 0;
  /// The state that reads that, at rest and deflected as little as can be.
  /// @param state  of MakeState
  virtual void StateAt(const Eigen::VectorXd& reading, TwinState& state) noexcept = 0;
  /// As it is now, between blocks.
  virtual void ReadState(TwinState& state) const noexcept {
    state.x = x_;
    state.theta = theta_;
    state.S = S_;
  }
  /// yp of this tick into `reading`, ny.
  virtual void Predict(Eigen::VectorXd& reading) noexcept = 0;
  /// One tick.
  /// @param inputs      commands u
  /// @param innovation  e, ny
  virtual void Step(std::span<const double> inputs,
                    const Eigen::VectorXd& innovation) noexcept = 0;
  /// After the last tick of a block: d yp / d theta of its ticks, one below the other,
  /// ny d x p; at rest the columns of the start are left out of account.
  virtual const Eigen::MatrixXd& EndBlock() noexcept = 0;
  /// theta + change, and the state that goes with it to first order. Between blocks.
  virtual void Shift(const Eigen::VectorXd& change) noexcept = 0;

  // Unknowns that wear may have grown evenly since it was started, from theta then on;
  // theta is not changed by that, but what it would do to the readings is known.

  /// Their places.
  const std::vector<Eigen::Index>& drifting() const { return drifting_; }
  /// After EndBlock: d yp / d rate of its ticks, ny d x drifting.
  const Eigen::MatrixXd& drift() const { return drift_; }
  /// Since it was started [s].
  virtual double drift_time() const noexcept { return drift_time_; }
  /// Whether that is followed, from the next start on.
  virtual void UseDrift(bool use) noexcept { drifts_ = use; }
  /// They have grown at these rates [1/s], and the state with them to first order.
  virtual void Drifted(const Eigen::VectorXd& rates) noexcept = 0;

 protected:
  /// @param tones     of which theta holds the parts, behind the factors
  /// @param drifting  places of unknowns that may grow
  Twin(const TwinShape& shape, std::vector<TwinGain> gains,
       std::vector<UnknownTone> tones, double sample_time,
       std::vector<Eigen::Index> drifting);

  const TwinGain& gain() const { return gains_[gain_]; }
  /// Unknowns of theta that act: all, or all but those of the start.
  Eigen::Index acting() const { return acting_; }
  /// Logarithm of a product of factors.
  double Logarithm(const std::vector<Eigen::Index>& factors) const noexcept;
  /// theta at a tick of a run.
  void Begin(const Eigen::VectorXd& theta, bool at_rest, Eigen::Index tick) noexcept;
  /// x_ and S_ in that state of a run in motion.
  /// @param directions  of the start, nx x start_unknowns
  void Place(const TwinState& state, const Eigen::MatrixXd& directions) noexcept;
  /// u_: those commands, and the tones.
  void Command(std::span<const double> inputs) noexcept;

  std::size_t gain_ = 0;
  Eigen::VectorXd theta_;  // p
  RunningTones tones_;
  Eigen::VectorXd u_;
  Eigen::VectorXd x_;  // nx
  Eigen::MatrixXd S_;  // nx x p
  bool drifts_ = true;
  std::vector<Eigen::Index> drifting_;
  Eigen::MatrixXd S_rate_;  // d x / d rate, nx x drifting
  Eigen::MatrixXd drift_;   // ny d x drifting
  double sample_time_;
  double drift_time_ = 0.0;

 private:
  TwinShape shape_;
  std::vector<TwinGain> gains_;
  Eigen::Index acting_ = 0;
};

}  // namespace mjdiag
