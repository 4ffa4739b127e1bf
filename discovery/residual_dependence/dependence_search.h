#pragma once
// The functions of one variable that FindResidualDependence (signature.h) tries: what each of
// them explains of a signal on parts of the record that it was not made from, and
// whether that is more than chance.

#include <Eigen/Core>

#include "mjdiag/discovery/residual_dependence/residual_dependence.h"

namespace mjdiag {

/// What one function of one variable, times a factor, explains.
struct Explanation {
  const Variable* variable = nullptr;
  const Variable* factor = nullptr;
  double share = -1.0;
  bool significant = false;
  bool simple = false;  ///< a step between a few values
  double period = 0.0;  ///< of a sine, else 0
  Eigen::VectorXd x = {};
  Eigen::VectorXd y = {};
  Eigen::VectorXd y_sd = {};
};

class ResidualDependenceSearch {
 public:
  /// @param signal     kept by reference
  /// @param signal_sd  of its noise
  /// @param tests      number of explanations tried: the level of each is 1 % over that
  ResidualDependenceSearch(const Eigen::VectorXd& signal, double signal_sd,
                           double tests);

  /// A constant in each of up to 40 bins, fewer if few samples are independent.
  Explanation Binned(const Variable& variable, const Variable* factor) const;
  /// One sine over x of at least two cycles; its curve is over one period.
  Explanation Sine(const Variable& variable) const;
  /// A constant in each of 40 parts of the record; not on unseen data.
  Explanation OverTime(const Variable& time) const;
  /// Whether the signal's mean is more than its noise explains.
  bool HasMean() const;

 private:
  /// Independent samples in what an explanation leaves over. A signal that is hardly
  /// larger than its noise is taken for noise and counts itself.
  double Independent(const Eigen::VectorXd& rest) const;
  bool Exceeds(double rest, double parameters, double independent, double level) const;
  Explanation BinnedInto(std::size_t bins, const Variable& variable,
                         const Variable* factor, double& independent) const;
  double FindPeriod(const Eigen::VectorXd& x) const;

  const Eigen::VectorXd& f_;
  double sd_;
  double level_;
  double total_;            ///< sum of squares about the mean
  double per_independent_;  ///< samples per independent one of the signal
};

}  // namespace mjdiag
