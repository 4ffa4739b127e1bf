#include "mjdiag/discovery/fitting/fit_coordinates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

bool IsMultiple(Role role) {
  return role == Role::kFactor || role == Role::kLength || role == Role::kVelocity ||
         role == Role::kSteepness || role == Role::kDuration;
}

}  // namespace

double ScaleOf(const FitParameter& parameter, double value, double duration) {
  switch (parameter.role) {
    case Role::kPhase:
      return 1.0;
    case Role::kFrequency:
      return std::min(value, 10.0 / duration);
    case Role::kFactor:
      // Around 1: what counts is how far it is from there.
      return std::max(std::abs(value - 1.0), 1e-3);
    default: {
      // What is nothing so far has to show what it would do.
      constexpr double kLittle = 1e-2;
      const double little =
          std::isfinite(parameter.spread) ? kLittle * parameter.spread : 0.0;
      return std::max({std::abs(value), little, 1e-12});
    }
  }
}

FitCoordinates FitCoordinates::Plain(Index size) {
  FitCoordinates plain;
  plain.units_ = VectorXd::Ones(size);
  plain.is_log_.assign(static_cast<std::size_t>(size), false);
  return plain;
}

FitCoordinates FitCoordinates::About(const std::vector<FitParameter>& parameters,
                                     const VectorXd& theta, double duration) {
  FitCoordinates own = Plain(theta.size());
  for (Index i = 0; i < theta.size(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    const FitParameter& parameter = parameters[place];
    // Numbers of the plant are logs of factors already, and of both signs.
    const bool is_log =
        IsMultiple(parameter.role) && parameter.lower >= 0.0 && theta[i] > 0.0;
    const bool is_shape = is_log && parameter.role != Role::kFactor;
    own.is_log_[place] = is_log;
    own.units_[i] = is_shape ? 1.0
                    : std::isfinite(parameter.spread)
                        ? parameter.spread
                        : ScaleOf(parameter, theta[i], duration);
  }
  return own;
}

VectorXd FitCoordinates::FromTheta(const VectorXd& theta) const {
  VectorXd x(theta.size());
  for (Index i = 0; i < theta.size(); ++i) x[i] = Bound(i, theta[i]);
  return x;
}

VectorXd FitCoordinates::ToTheta(const VectorXd& x) const {
  VectorXd theta = units_.cwiseProduct(x);
  for (Index i = 0; i < theta.size(); ++i) {
    if (is_log_[static_cast<std::size_t>(i)]) theta[i] = std::exp(theta[i]);
  }
  return theta;
}

VectorXd FitCoordinates::SlopeAt(const VectorXd& theta) const {
  VectorXd slope = units_;
  for (Index i = 0; i < theta.size(); ++i) {
    if (is_log_[static_cast<std::size_t>(i)]) slope[i] *= theta[i];
  }
  return slope;
}

double FitCoordinates::Bound(Index i, double theta) const {
  if (!is_log_[static_cast<std::size_t>(i)]) return theta / units_[i];
  if (!(theta > 0.0)) return -std::numeric_limits<double>::infinity();
  return std::log(theta) / units_[i];
}

}  // namespace mjdiag
