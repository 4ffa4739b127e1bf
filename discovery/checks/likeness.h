#pragma once
// Is one signal the other one, times a number?

#include <Eigen/Core>

namespace mjdiag {

struct Likeness {
  double factor = 1.0;       ///< measured over expected, of standard deviations
  double correlation = 0.0;  ///< without the means
  /// The same factor, within 3, and the same sign in every octave in which both move,
  /// over two octaves at least. One sine may be another one of any size and sign, for a
  /// machine with another resonance; over octaves only a column is.
  bool broad = false;
};

/// Signals of equal length. Without a correlation where one of them does not move.
Likeness Liken(const Eigen::VectorXd& measured, const Eigen::VectorXd& expected);

}  // namespace mjdiag
