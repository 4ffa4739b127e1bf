#include "mjdiag/plugin/design/gain_margins.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mjdiag/plugin/effects/kind.h"
#include "mjdiag/plugin/runtime/closed_loop.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// No mode may decay more slowly than the slowest of the healthy loop times this.
constexpr double kSlower = 3.0;
/// Margins are looked for between 1 and this, on a grid of as many equal factors.
constexpr double kWidest = 3.0;
constexpr int kSteps = 10;
constexpr int kSpringValues = 6;

double RadiusOf(const StateSpace& tick, Setup setup, const VectorXd& gains) {
  for (std::size_t i = 0; i < setup.control.axes.size(); ++i) {
    setup.control.axes[i].drive_gain *= gains[static_cast<Index>(i)];
  }
  return SpectralRadius(ClosedLoopMatrix(tick, setup));
}

/// Digits of `number` to that base as indices, one for each place.
std::vector<int> Digits(int number, int base, Index places) {
  std::vector<int> digits;
  for (Index i = 0; i < places; ++i, number /= base) digits.push_back(number % base);
  return digits;
}

int Power(int base, Index exponent) {
  int power = 1;
  for (Index i = 0; i < exponent; ++i) power *= base;
  return power;
}

StateSpace TickOf(const Machine& machine, const FaultFamily& family,
                  const VectorXd& parameters) {
  return TickModel(family.model_at(parameters), machine.rates().step(),
                   machine.rates().substeps);
}

/// Values from one to the other, in equal factors.
std::vector<double> Between(double least, double most, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(least * std::pow(most / least, i / (count - 1.0)));
  }
  return values;
}

/// Springs on a grid, each by itself, or all against all if they are two; a spring
/// between its ends may be worse than at them, where it meets a resonance. Dampers all
/// at one end or all at the other. The first is healthy.
std::vector<StateSpace> WornTicks(const Machine& machine, const FaultFamily& family,
                                  const FaultRange& range) {
  std::vector<Index> springs;
  std::vector<Index> dampers;
  Index place = 0;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    const Kind kind = KindOf(parameter.kind);
    if (kind == Kind::kCompliance) springs.push_back(place);
    if (kind == Kind::kViscousFriction) dampers.push_back(place);
    ++place;
  }
  const std::vector<double> stiffness =
      Between(range.least_stiffness, range.most_stiffness, kSpringValues);
  std::vector<VectorXd> grid{VectorXd::Ones(place)};
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const std::size_t others = springs.size() == 2 ? grid.size() : 1;
    for (std::size_t k = 0; k < others; ++k) {
      for (const double value : stiffness) {
        grid.push_back(grid[k]);
        grid.back()[springs[i]] = value;
      }
    }
  }
  std::vector<StateSpace> ticks{TickOf(machine, family, grid.front())};
  for (VectorXd& values : grid) {
    for (const double damping : {range.least_damping, range.most_damping}) {
      for (const Index damper : dampers) values[damper] = damping;
      ticks.push_back(TickOf(machine, family, values));
    }
  }
  return ticks;
}

double LargestRadius(const std::vector<StateSpace>& ticks, const Setup& setup,
                     const VectorXd& gains) {
  VectorXd radii(static_cast<Index>(ticks.size()));
  ParallelFor(static_cast<int>(ticks.size()), [&](int i) {
    radii[i] = RadiusOf(ticks[static_cast<std::size_t>(i)], setup, gains);
  });
  return radii.maxCoeff();
}

/// Over all corners of the margins.
double LargestRadius(const std::vector<StateSpace>& ticks, const Setup& setup,
                     const VectorXd& least, const VectorXd& most) {
  double largest = 0.0;
  for (int corner = 0; corner < Power(3, least.size()); ++corner) {
    const std::vector<int> side = Digits(corner, 3, least.size());
    VectorXd gains = VectorXd::Ones(least.size());
    for (Index i = 0; i < gains.size(); ++i) {
      if (side[static_cast<std::size_t>(i)] == 1) gains[i] = least[i];
      if (side[static_cast<std::size_t>(i)] == 2) gains[i] = most[i];
    }
    largest = std::max(largest, LargestRadius(ticks, setup, gains));
  }
  return largest;
}

}  // namespace

double LoopRadius(const Machine& machine, const FaultFamily& family,
                  const VectorXd& parameters, const VectorXd& gains) {
  return RadiusOf(TickOf(machine, family, parameters), machine.setup(), gains);
}

GainMargins FindGainMargins(const Machine& machine, const FaultFamily& family,
                            const FaultRange& range) {
  const Setup& setup = machine.setup();
  const std::vector<StateSpace> ticks = WornTicks(machine, family, range);
  const auto axes = static_cast<Index>(setup.control.axes.size());
  GainMargins margins;
  margins.least = margins.most = VectorXd::Ones(axes);
  margins.healthy_radius = RadiusOf(ticks.front(), setup, margins.most);
  if (!(margins.healthy_radius < 1.0)) {
    throw NumericalError("gain margins: the healthy loop is not stable");
  }
  const double slowest = std::pow(margins.healthy_radius, 1.0 / kSlower);
  margins.time_constant =
      -setup.rates.tick() / std::log(std::max(margins.healthy_radius, 1e-300));
  // Of one axis at a time, then closer to 1 until all of them together are within.
  const double step = std::pow(kWidest, 1.0 / kSteps);
  for (Index i = 0; i < axes; ++i) {
    for (const bool up : {false, true}) {
      double& margin = up ? margins.most[i] : margins.least[i];
      for (int k = 0; k < kSteps; ++k) {
        const double next = up ? margin * step : margin / step;
        VectorXd gains = VectorXd::Ones(axes);
        gains[i] = next;
        if (!(LargestRadius(ticks, setup, gains) <= slowest)) break;
        margin = next;
      }
    }
  }
  for (int k = 0; k <= kSteps; ++k) {
    margins.largest_radius = LargestRadius(ticks, setup, margins.least, margins.most);
    if (margins.largest_radius <= slowest) return margins;
    margins.least = (margins.least * step).cwiseMin(1.0);
    margins.most = (margins.most / step).cwiseMax(1.0);
  }
  throw NumericalError("gain margins: a worn machine is not stable");
}

}  // namespace mjdiag
