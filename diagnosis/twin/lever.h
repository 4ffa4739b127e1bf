#pragma once
// How an unknown acts on a mechanical model: as a generalised force,
//
//   d f / d theta = sum over its levers of  coefficient * signal * direction

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// What the force is proportional to.
enum class LeverSignal {
  kAcceleration,  ///< of a coordinate
  kVelocity,      ///< of a coordinate
  kPosition,      ///< of a coordinate
  kConstant,      ///< to nothing
  kInput,         ///< a command
  kSine,          ///< sin(2 pi f t) of a tone
  kCosine         ///< cos(2 pi f t) of a tone
};

struct Lever {
  std::vector<Eigen::Index> unknowns;  ///< factors of one number share its lever
  Eigen::Index direction = 0;          ///< column of LeverArms::directions
  LeverSignal signal = LeverSignal::kVelocity;
  Eigen::Index index = 0;    ///< of the coordinate, the command or the tone
  double coefficient = 0.0;  ///< of a unit of the number
  Eigen::Index number = -1;  ///< place of that number; -1: a tone
};

struct LeverArms {
  Eigen::MatrixXd directions;  ///< nq x directions
  std::vector<Lever> levers;
};

}  // namespace mjdiag
