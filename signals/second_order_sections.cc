#include "mjdiag/signals/second_order_sections.h"

#include <numbers>
#include <utility>

namespace mjdiag {

std::complex<double> FrequencyResponse(const SecondOrderSections& sections,
                                       double frequency, double sample_time) {
  const std::complex<double> delay =
      std::polar(1.0, -2.0 * std::numbers::pi * frequency * sample_time);
  std::complex<double> response = 1.0;
  for (const SecondOrderSection& section : sections) {
    response *= (section.b0 + delay * (section.b1 + delay * section.b2)) /
                (1.0 + delay * (section.a1 + delay * section.a2));
  }
  return response;
}

SectionFilter::SectionFilter(SecondOrderSections sections)
    : sections_(std::move(sections)), states_(sections_.size()) {}

void SectionFilter::Settle(double level) noexcept {
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const SecondOrderSection& section = sections_[i];
    const double output = section.StaticGain() * level;
    states_[i].first = output - section.b0 * level;
    states_[i].second = section.b2 * level - section.a2 * output;
    level = output;
  }
}

double SectionFilter::Update(double input) noexcept {
  double value = input;
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const SecondOrderSection& section = sections_[i];
    State& state = states_[i];
    const double output = section.b0 * value + state.first;
    state.first = section.b1 * value - section.a1 * output + state.second;
    state.second = section.b2 * value - section.a2 * output;
    value = output;
  }
  return value;
}

}  // namespace mjdiag
