#pragma once
// What a machine has that its model lacks, as functions of the moment: nothing here is an
// effect of plugin/effects, so that a search for causes is judged by laws that it does not
// share.

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace mjdiag::test {

/// A moment of a motion. Coordinates are those of the model, one a degree of freedom.
struct Moment {
  double t = 0.0;                  ///< since the start of the run [s]
  const Eigen::VectorXd& q;        ///< from the drawn configuration (qpos0) [m, rad]
  const Eigen::VectorXd& v;        ///< [m/s, rad/s]
  const Eigen::VectorXd& command;  ///< what the motors are told, as late as they are
  const Eigen::VectorXd& u;        ///< what they do
  const Eigen::VectorXd& z;        ///< what laws remember
};

struct HiddenPhysics {
  using Law = std::function<void(const Moment&, Eigen::VectorXd&)>;

  /// How late every actuator acts [s]; empty: at once.
  Eigen::VectorXd input_delay = {};
  /// z at the start.
  Eigen::VectorXd memory = {};
  std::vector<Law> drives = {};     ///< change u
  std::vector<Law> forces = {};     ///< add to the forces on the joints [N, N m]
  std::vector<Law> remembers = {};  ///< add to dz/dt
  /// Add to the bounds of ideal dry friction, beside the plant's own [N, N m].
  std::vector<Law> dry = {};
  /// Change what the encoders read, once a tick; may remember things of their own.
  std::vector<Law> readings = {};

  /// One more number that laws remember; its place in z.
  Eigen::Index Remember(double at_start) {
    memory.conservativeResize(memory.size() + 1);
    memory[memory.size() - 1] = at_start;
    return memory.size() - 1;
  }
};

}  // namespace mjdiag::test
