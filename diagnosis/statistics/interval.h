#pragma once
// From where to where a quantity goes: limits of a healthy residual, the extremes of a
// signal, the confidence interval of an estimate.

namespace mjdiag {

struct Interval {
  double min = 0.0;
  double max = 0.0;
  bool Holds(double value) const { return value > min && value < max; }
};

}  // namespace mjdiag
