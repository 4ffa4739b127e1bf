#pragma once
// What a cause of size 1 does to a run, along the motion: forces, or errors of readings.

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace mjdiag {

struct Column {
  /// Degrees of freedom, and the force on each, samples [N, N m].
  std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> forces{};
  /// Coordinates of the state, and how far each is off after the tick, samples [its unit].
  std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> states{};
  /// Sensors, and what each reads too much, samples [its unit].
  std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> readings{};
};

}  // namespace mjdiag
