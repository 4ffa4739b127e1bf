#pragma once
// The model that runs beside a machine: it gets the same commands, predicts the
// readings, and knows how its predictions change with each unknown,
//
//   x[k+1] = f(x[k], u[k]; theta) + L e[k],    yp[k] = h(x[k]),    e[k] = y[k] - yp[k]
//   S[k] = d x[k] / d theta
//
// theta: whatever is not known of the machine (Unknown). L is a constant gain that
// pulls the model towards the readings, 0 where the model is trusted. Sensitivities are
// given for means over a block of ticks: averaging white noise over a block loses
// nothing of what varies slowly, and costs less than every tick by itself.
//
// [Ljung83] L. Ljung, T. Soderstrom, "Theory and Practice of Recursive Identification",
// MIT Press, 1983, chapter 3.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace mjdiag {

/// A number of the machine that is to be estimated.
struct Unknown {
  std::string name;
  double nominal = 1.0;   ///< value to begin with
  double prior_sd = 1.0;  ///< how well that is known: of theta, see `factor`
  /// The value is a factor that stays above 0. What is estimated is its logarithm,
  /// theta = ln(value), and prior_sd is of that; else theta = value.
  bool factor = false;
};

class Twin {
 public:
  virtual ~Twin() = default;

  virtual Eigen::Index outputs() const = 0;  ///< ny
  virtual Eigen::Index inputs() const = 0;   ///< nu
  /// p: of the machine, then of the state at the start of the run.
  virtual Eigen::Index unknowns() const = 0;
  /// How many of them are of that state, in standard deviations of it.
  virtual Eigen::Index start_unknowns() const = 0;
  /// Ticks of a block.
  virtual Eigen::Index block() const = 0;

  // Nothing below allocates, locks, throws or does I/O.

  /// Back to the start of a run.
  /// @param theta    p
  /// @param at_rest  else in the remembered state and what theta says beside it; at
  ///                 rest that part of theta is left out of account
  virtual void Start(const Eigen::VectorXd& theta, bool at_rest) noexcept = 0;
  /// Moves it to where `reading` says that it is, by the smallest deflection.
  virtual void Place(const Eigen::VectorXd& reading) noexcept = 0;
  /// The present state becomes the one in which runs start.
  virtual void Remember() noexcept = 0;
  /// yp of this tick into `reading`, ny.
  virtual void Predict(Eigen::VectorXd& reading) noexcept = 0;
  /// One tick.
  /// @param inputs      commands u
  /// @param innovation  e, ny, by which it is pulled back; 0: not
  virtual void Step(std::span<const double> inputs,
                    const Eigen::VectorXd& innovation) noexcept = 0;
  /// After the last tick of a block: d mean(yp) / d theta over it, ny x p; at rest the
  /// columns of the state are left out of account.
  virtual const Eigen::MatrixXd& EndBlock() noexcept = 0;
  /// theta + change, and the state that goes with it to first order. Between blocks.
  virtual void Shift(const Eigen::VectorXd& change) noexcept = 0;
};

}  // namespace mjdiag
