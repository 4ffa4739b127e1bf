#pragma once
// What does a signal that no known cause explains depend on, and how? Of every variable
// at hand (positions, velocities, accelerations, inputs, directions, time) it is asked
// how much of the signal a function of it predicts, on parts of the record that the
// function was not made from:
//
//   f[k] = g(x[k]) m[k] + rest,    share = 1 - sum (f - g m)^2 / sum (f - mean f)^2
//
// m = 1, or one of the variables that are marked as factors (the direction or velocity
// of the site itself), with which friction that depends on a position, or damping that
// does, are found. g is
//   - constant in each of up to 40 bins of equally many samples, or
//   - for positions [m, rad] and time [s]: one sine, whose period is where the
//     periodogram over x has its peak (for ripples too fine for the bins).
// Held out are blocks of the record, every fifth of 40, not samples: neighbours in time
// are alike, and a signal that merely is smooth would predict itself. What is left over
// says how alike: of n samples with autocorrelation rho, n / (1 + 2 sum rho) count as
// independent. Of these many an F test asks whether g is more than chance, with the
// number of variables, factors and periods tried taken into account. A signal that is
// less than twice its noise may be all noise: it is judged by its own autocorrelation.
//
// Time is different: every signal is a function of it, so g in bins of time is believed
// only if no other variable predicts half as much, and is judged against the noise.
//
// The largest share wins; a variable with a factor has to explain clearly more than the
// best without. The curve g of the winner is put into words by the simplest form of a
// list that describes it (Bayesian information criterion).

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mjdiag {

/// A series that a signal may depend on.
struct Variable {
  std::string name;        ///< "X velocity"
  std::string unit;        ///< "m/s"; time has "s"
  Eigen::VectorXd value;   ///< one for every sample
  bool is_factor = false;  ///< may multiply a function of another variable
};

struct ResidualDependence {
  std::string site;
  std::string variable;  ///< empty if nothing is significant
  std::string unit;      ///< of x
  std::string factor;    ///< name of m, empty for 1
  std::string shape;     ///< for example "linear", "none" if nothing is significant
  double explained_share = 0.0;  ///< of unseen parts of the record, at most 1
  bool significant = false;
  double period = 0.0;    ///< of a periodic shape [unit of x], else 0
  double exponent = 0.0;  ///< of a power of x, else 0
  /// The next best variable, and what it explains alone.
  std::string runner_up;
  double runner_up_share = 0.0;
  /// g over x and its standard deviation; of a sine that was found by its periodogram
  /// over one period, 0 <= x < period.
  Eigen::VectorXd x, y, y_sd;
  std::string text;  ///< one sentence
};

/// @param site       of the signal, for the text
/// @param signal     f [signal_unit], at least 400 samples
/// @param signal_sd  of the noise on it, > 0; its spectrum does not matter
/// @param variables  as long as f; constant ones are passed over
/// InputError on lengths that differ and values that are not finite.
ResidualDependence FindResidualDependence(const std::string& site,
                                          const Eigen::VectorXd& signal,
                                          const std::string& signal_unit,
                                          double signal_sd,
                                          const std::vector<Variable>& variables);

}  // namespace mjdiag
