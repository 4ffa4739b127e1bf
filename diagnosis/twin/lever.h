#pragma once
// How an unknown acts on a mechanical model: as a generalised force,
//
//   d f / d theta = sum over its levers of  coefficient * signal * direction

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// What the force is proportional to.
enum class LeverSignal {
  kVelocity,  ///< of a coordinate
  kPosition,  ///< of a coordinate
  kInput,     ///< a command
  kSine,      ///< sin(2 pi f t) of a tone
  kCosine     ///< cos(2 pi f t) of a tone
};

struct Lever {
  Eigen::Index unknown = 0;
  Eigen::Index direction = 0;  ///< column of LeverArms::directions
  LeverSignal signal = LeverSignal::kVelocity;
  Eigen::Index index = 0;  ///< of the coordinate, the command or the tone
  double coefficient = 0.0;
};

struct LeverArms {
  Eigen::MatrixXd directions;  ///< nq x directions
  std::vector<Lever> levers;
  std::vector<double> tones;  ///< frequencies [Hz]
};

}  // namespace mjdiag
