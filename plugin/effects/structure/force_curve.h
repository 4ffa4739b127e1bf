#pragma once
// A force at a joint that nobody has a name for, as a smooth curve over what predicts it:
//
//   F = m g(x)
//
//   x  a position or velocity of any joint, the command of an actuator, or time
//   m  1, the direction of the joint, tanh(v / still), or its velocity v
//   g  cubic between `knots` values at equal distances over low .. low + width, with the slopes
//      of Catmull and Rom (1974), those at its ends of the parabola through three, held at
//      its ends beyond. A periodic one is the same
//      again after its width; one that is split at 0 is two, half of the knots over
//      low .. 0 and half over 0 .. low + width, and goes from one to the other within `still`,
//      as friction does
//
// It is not looked for among the laws: it is learned where none of them is left
// (discovery/blocks/curve_block.h).

#include <Eigen/Core>
#include <array>

namespace mjdiag {

/// What the parameter `variable` stands for; `of` is the degree of freedom or the
/// actuator, by its number in the MJCF.
enum class CurveVariable { kPosition, kVelocity, kCommand, kTime };
/// What the parameter `factor` stands for.
enum class CurveFactor { kNone, kDirection, kVelocity };

/// What the parameter `shape` stands for.
enum class CurveShapes { kPlain, kPeriodic, kSplit };

/// Where the knots of a curve are.
struct CurveAxis {
  double low = 0.0;
  double high = 1.0;
  CurveShapes shape = CurveShapes::kPlain;
  int knots = 4;
  double still = 0.0;  ///< of x, of a split one

  /// Of the curve at x, which knots count there, and how much: g = sum weight f[place].
  struct Weights {
    std::array<int, 8> place{};
    std::array<double, 8> weight{};
  };
  Weights At(double x) const noexcept;
  /// Of knot `place`, from 0. A split curve has two at 0.
  double KnotAt(int place) const noexcept;
};

/// Places of the parameters of force_curve; its knots come behind them.
namespace force_curve {
enum Place { kVariable, kOf, kFactor, kStill, kLow, kWidth, kShape, kKnots, kFirst };
inline constexpr int kFewestKnots = 4;
inline constexpr int kMostKnots = 17;
}  // namespace force_curve

/// As the parameters say.
CurveAxis CurveAxisOf(const Eigen::VectorXd& values);

/// m for the velocity of the joint.
double FactorOf(CurveFactor factor, double velocity, double still) noexcept;

}  // namespace mjdiag
