#pragma once
// Digital filters as a chain of second-order sections,
//   H(z) = prod_i (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2)
// which keeps its poles where a polynomial of order seven at a low cut-off frequency
// loses them to rounding.

#include <complex>
#include <vector>

namespace mjdiag {

/// A section of first order has b2 = a2 = 0.
struct SecondOrderSection {
  double b0 = 1.0;
  double b1 = 0.0;
  double b2 = 0.0;
  double a1 = 0.0;
  double a2 = 0.0;

  /// Gain at frequency 0.
  double StaticGain() const { return (b0 + b1 + b2) / (1.0 + a1 + a2); }
  int order() const { return a2 != 0.0 || b2 != 0.0 ? 2 : 1; }
};

using SecondOrderSections = std::vector<SecondOrderSection>;

/// H at z = exp(i 2 pi f T).
/// @param frequency    f [Hz]
/// @param sample_time  T [s]
std::complex<double> FrequencyResponse(const SecondOrderSections& sections,
                                       double frequency, double sample_time);

/// The filter at work, a sample at a time (direct form II transposed). Nothing in
/// Update, Settle and Reset allocates, locks or throws.
class SectionFilter {
 public:
  /// Starts with zero states.
  explicit SectionFilter(SecondOrderSections sections);

  /// Back to zero states.
  void Reset() noexcept { Settle(0.0); }
  /// Takes the states that a constant input of `level` leads to: no transient follows
  /// if the signal goes on from there. No pole may lie at z = 1.
  void Settle(double level) noexcept;
  /// The output for the next sample.
  double Update(double input) noexcept;

 private:
  struct State {
    double first = 0.0;
    double second = 0.0;
  };
  SecondOrderSections sections_;
  std::vector<State> states_;
};

}  // namespace mjdiag
