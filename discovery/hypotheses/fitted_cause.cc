#include "mjdiag/discovery/hypotheses/fitted_cause.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

FittedCause Bounded(const std::vector<Candidate>& candidates, FittedCause cause) {
  Index i = 0;
  for (const FitParameter& parameter : candidates[cause.candidate].parameters) {
    double& value = cause.value[i++];
    value = std::clamp(value, parameter.lower, parameter.upper);
  }
  return cause;
}

bool IsAtItsEnd(const std::vector<Candidate>& candidates, const FittedCause& cause) {
  constexpr double kAt = 1e-6;       // of the bound
  constexpr double kNothing = 1e-3;  // of the size that is expected
  const auto& parameters = candidates[cause.candidate].parameters;
  const auto sizes =
      std::ranges::count(parameters, Role::kAmplitude, &FitParameter::role);
  Index i = 0;
  for (const FitParameter& parameter : parameters) {
    const double value = cause.value[i++];
    if (parameter.role == Role::kAmplitude && sizes > 1 && parameter.lower == 0.0 &&
        std::isfinite(parameter.spread) && value <= kNothing * parameter.spread) {
      return true;
    }
    if (!IsShape(parameter.role) || parameter.role == Role::kPhase) continue;
    const double upper = parameter.upper;
    const double lower = parameter.lower;
    if (std::isfinite(upper) && value >= upper - kAt * std::abs(upper)) return true;
    if (lower != 0.0 && value <= lower + kAt * std::abs(lower)) return true;
  }
  return false;
}

bool Has(const std::vector<FittedCause>& causes, std::size_t candidate) {
  return std::ranges::find(causes, candidate, &FittedCause::candidate) != causes.end();
}

int ParameterCount(const std::vector<FittedCause>& causes) {
  int count = 0;
  for (const FittedCause& cause : causes) count += static_cast<int>(cause.value.size());
  return count;
}

VectorXd Flatten(const std::vector<FittedCause>& causes) {
  Index size = 0;
  for (const FittedCause& cause : causes) size += cause.value.size();
  VectorXd all(size);
  Index next = 0;
  for (const FittedCause& cause : causes) {
    all.segment(next, cause.value.size()) = cause.value;
    next += cause.value.size();
  }
  return all;
}

std::vector<FittedCause> WithValues(std::vector<FittedCause> causes,
                                    const VectorXd& all) {
  Index next = 0;
  for (FittedCause& cause : causes) {
    cause.value = all.segment(next, cause.value.size());
    next += cause.value.size();
  }
  return causes;
}

std::vector<FitParameter> ParametersOf(const std::vector<Candidate>& candidates,
                                       const std::vector<FittedCause>& causes) {
  std::vector<FitParameter> parameters;
  for (const FittedCause& cause : causes) {
    const auto& list = candidates[cause.candidate].parameters;
    parameters.insert(parameters.end(), list.begin(), list.end());
  }
  return parameters;
}

Cause CauseOf(const std::vector<Candidate>& candidates, const FittedCause& fitted) {
  const Candidate& candidate = candidates[fitted.candidate];
  VectorXd values =
      VectorXd::Zero(static_cast<Index>(candidate.effect->parameters().size()));
  const Index choices = candidate.chosen.size();
  values.head(choices) = candidate.chosen;
  values.segment(choices, fitted.value.size()) = fitted.value;
  return {candidate.effect, candidate.site, std::move(values)};
}

Changes ChangesOf(const std::vector<Candidate>& candidates,
                  const std::vector<FittedCause>& causes) {
  std::vector<Cause> list;
  list.reserve(causes.size());
  for (const FittedCause& fitted : causes) {
    list.push_back(CauseOf(candidates, fitted));
  }
  return ChangesOf(list);
}

std::vector<FittedCause> Without(const std::vector<FittedCause>& causes,
                                 const std::vector<std::size_t>& places) {
  std::vector<FittedCause> left;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    if (std::ranges::find(places, i) == places.end()) left.push_back(causes[i]);
  }
  return left;
}

}  // namespace mjdiag
