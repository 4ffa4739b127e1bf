#include "mjdiag/signals/discretize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

/// x'' + 2 z w x' + w^2 x = w^2 u, y = x
StateSpace Oscillator(double w, double z) {
  StateSpace system;
  system.A = MatrixXd{{0.0, 1.0}, {-w * w, -2.0 * z * w}};
  system.B = MatrixXd{{0.0}, {w * w}};
  system.C = MatrixXd{{1.0, 0.0}};
  system.D = MatrixXd{{0.0}};
  return system;
}

std::complex<double> Response(const StateSpace& system, std::complex<double> point) {
  const Eigen::MatrixXcd resolvent =
      point * MatrixXd::Identity(system.states(), system.states()) - system.A;
  return (system.C * SolveComplex(resolvent, system.B) + system.D)(0, 0);
}

TEST(DiscretizeZoh, IsTheExactSolutionOfAnOscillator) {
  constexpr double kT = 1.0 / 8000.0;
  const double w = 2.0 * std::numbers::pi * 2600.0;
  constexpr double kZ = 0.02;
  const StateSpace discrete = DiscretizeZoh(Oscillator(w, kZ), kT);
  const double wd = w * std::sqrt(1.0 - kZ * kZ);
  const double decay = std::exp(-kZ * w * kT);
  const double c = std::cos(wd * kT);
  const double s = std::sin(wd * kT);
  EXPECT_NEAR(discrete.A(0, 0), decay * (c + kZ * w / wd * s), 1e-13);
  EXPECT_NEAR(discrete.A(0, 1), decay * s / wd, 1e-13 / w);
  EXPECT_NEAR(discrete.A(1, 0), -decay * w * w / wd * s, 1e-13 * w);
  EXPECT_NEAR(discrete.A(1, 1), decay * (c - kZ * w / wd * s), 1e-13);
  EXPECT_NEAR(discrete.B(0, 0), 1.0 - decay * (c + kZ * w / wd * s), 1e-13);
  EXPECT_NEAR(discrete.B(1, 0), decay * w * w / wd * s, 1e-13 * w);
  EXPECT_EQ(discrete.sample_time, kT);
}

TEST(DiscretizeZoh, IntegratesAFreeMass) {
  StateSpace mass = Oscillator(1.0, 0.0);
  mass.A(1, 0) = 0.0;
  const StateSpace discrete = DiscretizeZoh(mass, 0.5);
  EXPECT_TRUE(discrete.A.isApprox(MatrixXd{{1.0, 0.5}, {0.0, 1.0}}, 1e-15));
  EXPECT_TRUE(discrete.B.isApprox(MatrixXd{{0.125}, {0.5}}, 1e-15));
}

TEST(DiscretizeTustin, KeepsTheResponseOnTheWarpedAxis) {
  constexpr double kT = 1e-3;
  const StateSpace continuous = Oscillator(600.0, 0.1);
  const StateSpace discrete = DiscretizeTustin(continuous, kT);
  for (const double f : {1.0, 90.0, 300.0}) {
    const std::complex<double> s(0.0, 2.0 / kT * std::tan(std::numbers::pi * f * kT));
    const auto z = std::polar(1.0, 2.0 * std::numbers::pi * f * kT);
    EXPECT_NEAR(std::abs(Response(discrete, z) - Response(continuous, s)), 0.0, 1e-12);
  }
}

TEST(Discretize, RefusesWhatItCannotDo) {
  const StateSpace good = Oscillator(1.0, 0.1);
  StateSpace discrete = good;
  discrete.sample_time = 1.0;
  StateSpace misshapen = good;
  misshapen.B = MatrixXd::Zero(3, 1);
  for (const auto discretize : {DiscretizeZoh, DiscretizeTustin}) {
    EXPECT_THROW(discretize(discrete, 1.0), InputError);
    EXPECT_THROW(discretize(misshapen, 1.0), InputError);
    EXPECT_THROW(discretize(good, 0.0), InputError);
    EXPECT_THROW(discretize(good, -1.0), InputError);
  }
  StateSpace unstable = good;
  unstable.A = MatrixXd{{2.0, 0.0}, {0.0, -1.0}};
  EXPECT_THROW(DiscretizeTustin(unstable, 1.0), NumericalError);
  unstable.A *= 1e6;
  EXPECT_THROW(DiscretizeZoh(unstable, 1.0), NumericalError);
}

}  // namespace
}  // namespace mjdiag
