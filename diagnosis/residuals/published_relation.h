#pragma once
// A parity relation that was printed somewhere, against the one that a model gives:
// every printed coefficient is a measurement of the machine with a known rounding.

#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"

namespace mjdiag {

/// Numerator of one channel of a printed relation.
struct PrintedPolynomial {
  std::string channel;               ///< an input or output of the model
  std::vector<double> coefficients;  ///< ascending powers of s; 0: nothing to compare
};

/// A coefficient that makes the relation unique (Eq. 32: three zeros and the scale).
struct PrintedPin {
  std::string channel;  ///< an output of the model
  int power = 0;
  double value = 0.0;
};

struct PublishedRelation {
  int degree = 0;
  int digits = 0;  ///< significant digits in print
  std::vector<PrintedPin> pins;
  std::vector<PrintedPolynomial> polynomials;
};

struct CoefficientComparison {
  std::string channel;
  int power = 0;
  double printed = 0.0;
  double computed = 0.0;
  double half_ulps = 0.0;  ///< |computed - printed| in halves of the last printed digit
};

struct PublishedRelationComparison {
  double worst_half_ulp = 0.0;  ///< up to 1: the print is the rounded computation
  std::vector<CoefficientComparison> coefficients;  ///< pins are left out
};

/// InputError on a channel that the model has not got; NumericalError if the pins do
/// not make the relation unique.
PublishedRelationComparison ComparePublishedRelation(
    const MechanicalModel& model, const PublishedRelation& published);

}  // namespace mjdiag
