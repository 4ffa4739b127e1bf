#include "mjdiag/discovery/fit/model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/hypotheses/fitted_cause.h"
#include "mjdiag/plugin/effects/wave.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

Coordinate OfParameter(const FitParameter& parameter, double theta) {
  Coordinate one;
  const bool sized = std::isfinite(parameter.spread) && parameter.spread > 0.0;
  const double size = std::max(std::abs(theta), 1e-12);
  switch (parameter.role) {
    case Role::kAmplitude:
    case Role::kTime:
      one.unit = sized ? parameter.spread : size;
      one.is_known = sized;
      break;
    case Role::kFactor:
      one.is_log = parameter.lower >= 0.0;
      one.unit = sized ? parameter.spread : 1.0;
      one.is_known = sized;
      break;
    case Role::kLength:
    case Role::kVelocity:
    case Role::kSteepness:
    case Role::kDuration:
    case Role::kPeriod:
    case Role::kFrequency:
      one.is_log = parameter.lower >= 0.0 && theta > 0.0;
      one.unit = one.is_log ? 1.0 : size;
      if (one.is_log && parameter.extent > 0.0) {
        // A turn of the phase along all that was seen.
        const double turns = parameter.role == Role::kPeriod ? parameter.extent / theta
                                                             : parameter.extent * theta;
        one.unit = std::min(1.0, 1.0 / (kTurn * turns));
      }
      break;
    case Role::kPhase:
    case Role::kRatio:
      break;
    default:
      one.unit = sized ? parameter.spread : size;
      break;
  }
  one.lower = one.ToX(parameter.lower);
  one.upper = one.ToX(parameter.upper);
  return one;
}

/// Where a member is on its axis of waves or resonances, and how far it reaches there.
struct Line {
  double at = 0.0;
  double half_width = 0.0;
};

/// Of waves in turns along all that was seen, of resonances in Hz; none of anything else.
std::optional<Line> LineOf(const Block& block, const VectorXd& values) {
  if (!block.candidate) return std::nullopt;
  const Candidate& candidate = *block.candidate;
  const Index period = PeriodPlace(candidate);
  if (period >= std::ssize(candidate.parameters)) return std::nullopt;
  const double value = values[period];
  const FitParameter& parameter =
      candidate.parameters[static_cast<std::size_t>(period)];
  if (block.IsWave()) {
    if (!(parameter.extent > 0.0)) return std::nullopt;
    constexpr double kHalfTurn = 0.5;
    return Line{parameter.role == Role::kPeriod ? parameter.extent / value
                                                : parameter.extent * value,
                kHalfTurn};
  }
  const Index ratio = PlaceOf(candidate, Role::kRatio);
  if (parameter.role != Role::kFrequency || ratio >= values.size()) return std::nullopt;
  return Line{value, values[ratio] * value};
}

}  // namespace

double Coordinate::ToX(double theta) const {
  if (!is_log) return theta / unit;
  return theta > 0.0 ? std::log(theta) / unit : -kAny;
}

double Coordinate::Step(double x) const {
  constexpr double kStep = 1e-3;
  const double step = is_log ? kStep : std::max(kStep * std::abs(x), 1e-6);
  return x + step > upper ? -step : step;
}

double Coordinate::ToTheta(double x) const {
  return is_log ? std::exp(unit * x) : unit * x;
}

Changes ChangesOfModel(const std::vector<Block>& blocks, const Model& model) {
  Changes changes;
  for (const Member& member : model) {
    const Block& block = blocks[member.block];
    if (block.number) {
      changes.numbers.emplace_back(*block.number, member.values[0]);
      continue;
    }
    const Changes own = ChangesOfFit({*block.candidate}, {{0, member.values}});
    changes.faults.insert(changes.faults.end(), own.faults.begin(), own.faults.end());
    changes.effects.insert(changes.effects.end(), own.effects.begin(),
                           own.effects.end());
  }
  return changes;
}

Model Without(Model model, std::size_t place) {
  model.erase(model.begin() + static_cast<std::ptrdiff_t>(place));
  return model;
}

bool HaveSameBlocks(const Model& a, const Model& b) {
  return std::ranges::is_permutation(a, b, {}, &Member::block, &Member::block);
}

bool AreNear(const Model& a, const Model& b, double share) {
  return std::ranges::equal(a, b, [&](const Member& one, const Member& other) {
    return one.block == other.block && one.values.isApprox(other.values, share);
  });
}

bool IsResolved(const std::vector<Block>& blocks, const Model& model) {
  for (std::size_t m = 0; m < model.size(); ++m) {
    const auto one = LineOf(blocks[model[m].block], model[m].values);
    if (!one) continue;
    for (std::size_t n = 0; n < m; ++n) {
      if (model[n].block != model[m].block) continue;
      const auto other = LineOf(blocks[model[n].block], model[n].values);
      if (std::abs(one->at - other->at) < one->half_width + other->half_width) {
        return false;
      }
    }
  }
  return true;
}

std::string ModelText(const std::vector<Block>& blocks, const Model& model) {
  std::string text;
  for (const Member& member : model) {
    text += (text.empty() ? "" : ", ") + blocks[member.block].name + "(";
    for (Index i = 0; i < member.values.size(); ++i) {
      char value[32];
      std::snprintf(value, sizeof value, "%s%.5g", i == 0 ? "" : " ", member.values[i]);
      text += value;
    }
    text += ")";
  }
  return text.empty() ? "nothing" : text;
}

std::vector<Coordinate> CoordinatesOf(const std::vector<Block>& blocks,
                                      const Model& model) {
  std::vector<Coordinate> all;
  for (std::size_t m = 0; m < model.size(); ++m) {
    const Block& block = blocks[model[m].block];
    if (block.number) {
      all.push_back({m, 0, true, block.doubt, true, -kFarthest, kFarthest});
      continue;
    }
    for (Index i = 0; i < model[m].values.size(); ++i) {
      const FitParameter& parameter =
          block.candidate->parameters[static_cast<std::size_t>(i)];
      if (parameter.role == Role::kChoice) continue;
      Coordinate one = OfParameter(parameter, model[m].values[i]);
      one.member = m;
      one.value = i;
      all.push_back(one);
    }
  }
  return all;
}

VectorXd Place(const std::vector<Coordinate>& coordinates, const Model& model) {
  VectorXd x(std::ssize(coordinates));
  for (Index i = 0; i < x.size(); ++i) {
    const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
    x[i] =
        std::clamp(one.ToX(model[one.member].values[one.value]), one.lower, one.upper);
  }
  return x;
}

Model At(const std::vector<Coordinate>& coordinates, Model model, const VectorXd& x) {
  for (Index i = 0; i < x.size(); ++i) {
    const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
    model[one.member].values[one.value] = one.ToTheta(x[i]);
  }
  return model;
}

MovedOnce Moved(const std::vector<Coordinate>& coordinates, const Model& model,
                Index place) {
  VectorXd x = Place(coordinates, model);
  const double step = coordinates[static_cast<std::size_t>(place)].Step(x[place]);
  x[place] += step;
  return {At(coordinates, model, x), step};
}

Eigen::MatrixXd WhiteningOf(const std::vector<Block>& blocks, const Model& model,
                            const std::vector<Coordinate>& coordinates) {
  const Index size = std::ssize(coordinates);
  Eigen::MatrixXd R = Eigen::MatrixXd::Identity(size, size);
  for (Index i = 0; i < size; ++i) {
    const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
    const Block& block = blocks[model[one.member].block];
    if (one.value != 0 || !block.candidate || !IsCurve(*block.candidate)) continue;
    const Eigen::MatrixXd knots = WhiteningOfKnots(*block.candidate);
    R.block(i, i, knots.rows(), knots.cols()) = knots;
  }
  return R;
}

}  // namespace mjdiag
