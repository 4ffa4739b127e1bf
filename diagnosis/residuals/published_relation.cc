#include "mjdiag/diagnosis/residuals/published_relation.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// Index of a channel, or -1.
Index PlaceOf(const std::vector<std::string>& channels, const std::string& channel) {
  const auto found = std::find(channels.begin(), channels.end(), channel);
  return found == channels.end() ? -1 : std::distance(channels.begin(), found);
}

std::vector<PinnedCoefficient> PinsOf(const MechanicalModel& model,
                                      const PublishedRelation& published) {
  std::vector<PinnedCoefficient> pins;
  for (const PrintedPin& pin : published.pins) {
    const Index output = PlaceOf(model.outputs, pin.channel);
    if (output < 0) {
      throw InputError("published parity relation",
                       "pin on unknown channel \"" + pin.channel + "\"",
                       "an output of the model");
    }
    pins.push_back({output, pin.power, pin.value});
  }
  return pins;
}

/// The computed polynomial of a channel, ascending powers.
Eigen::RowVectorXd PolynomialOf(const MechanicalModel& model,
                                const ParityRelation& relation,
                                const std::string& channel) {
  if (const Index output = PlaceOf(model.outputs, channel); output >= 0) {
    return relation.outputs.row(output);
  }
  if (const Index input = PlaceOf(model.inputs, channel); input >= 0) {
    return relation.inputs.row(input);
  }
  throw InputError("published parity relation", "unknown channel \"" + channel + "\"",
                   "an input or output of the model");
}

bool IsPinned(const PublishedRelation& published, const std::string& channel,
              int power) {
  return std::any_of(published.pins.begin(), published.pins.end(),
                     [&](const PrintedPin& pin) {
                       return pin.channel == channel && pin.power == power;
                     });
}

/// Half a unit in the last printed digit.
double HalfUlp(double printed, int digits) {
  return 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(printed))) - digits + 1);
}

}  // namespace

PublishedRelationComparison ComparePublishedRelation(
    const MechanicalModel& model, const PublishedRelation& published) {
  const ParityRelation relation =
      PinnedParityRelation(model, published.degree, PinsOf(model, published));
  PublishedRelationComparison comparison;
  for (const PrintedPolynomial& polynomial : published.polynomials) {
    const Eigen::RowVectorXd computed =
        PolynomialOf(model, relation, polynomial.channel);
    const auto powers =
        std::min(static_cast<Index>(polynomial.coefficients.size()), computed.size());
    for (int power = 0; power < powers; ++power) {
      const double printed = polynomial.coefficients[static_cast<std::size_t>(power)];
      if (printed == 0.0 || IsPinned(published, polynomial.channel, power)) continue;
      const double half_ulps =
          std::abs(computed[power] - printed) / HalfUlp(printed, published.digits);
      comparison.coefficients.push_back(
          {polynomial.channel, power, printed, computed[power], half_ulps});
      comparison.worst_half_ulp = std::max(comparison.worst_half_ulp, half_ulps);
    }
  }
  return comparison;
}

}  // namespace mjdiag
