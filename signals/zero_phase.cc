#include "mjdiag/signals/zero_phase.h"

#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Index PaddingLength(const SecondOrderSections& sections) {
  Index order = 0;
  for (const SecondOrderSection& section : sections) order += section.order();
  return 3 * order;
}

VectorXd ExtendByReflection(const VectorXd& signal, Index padding) {
  const Index size = signal.size();
  VectorXd extended(size + 2 * padding);
  extended.segment(padding, size) = signal;
  for (Index k = 1; k <= padding; ++k) {
    extended[padding - k] = 2.0 * signal[0] - signal[k];
    extended[padding + size - 1 + k] = 2.0 * signal[size - 1] - signal[size - 1 - k];
  }
  return extended;
}

/// Filters in place, in either direction of time.
template <typename Signal>
void FilterOnce(SectionFilter& filter, Signal&& signal) {
  filter.Settle(signal[0]);
  for (Index k = 0; k < signal.size(); ++k) signal[k] = filter.Update(signal[k]);
}

}  // namespace

VectorXd FilterZeroPhase(const SecondOrderSections& sections, const VectorXd& signal) {
  const Index padding = PaddingLength(sections);
  if (signal.size() <= padding) {
    throw InputError("zero-phase filter",
                     "a signal of " + std::to_string(signal.size()) + " samples",
                     "more than " + std::to_string(padding));
  }
  VectorXd extended = ExtendByReflection(signal, padding);
  SectionFilter filter(sections);
  FilterOnce(filter, extended);
  FilterOnce(filter, extended.reverse());
  return extended.segment(padding, signal.size());
}

}  // namespace mjdiag
