#include "mjdiag/comparison/missing_force.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/replay/force_smoother.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFastest = 32.0;  // times the bandwidth of the motion

/// Changes of every row in a tick, over 20 ms to each side.
MatrixXd ChangesOf(const MatrixXd& rows, double tick) {
  constexpr double kSide = 0.02;  // [s]
  const auto side = std::max<Index>(2, static_cast<Index>(std::lround(kSide / tick)));
  MatrixXd changes(rows.rows(), rows.cols());
  for (Index k = 0; k < rows.cols(); ++k) {
    const Index first = std::max<Index>(0, k - side);
    const Index last = std::min(rows.cols() - 1, k + side);
    changes.col(k) = (rows.col(last) - rows.col(first)) /
                     static_cast<double>(std::max<Index>(1, last - first));
  }
  return changes;
}

/// [rad a tick] Of the fastest reading, by its rms acceleration over its rms velocity.
double MotionBandwidth(const MeasuredRun& run) {
  const MatrixXd velocity = ChangesOf(run.outputs, run.sample_time);
  const MatrixXd acceleration = ChangesOf(velocity, run.sample_time);
  return (acceleration.rowwise().norm().array() /
          velocity.rowwise().norm().array().max(1e-300))
      .maxCoeff();
}

}  // namespace

std::vector<Index> ForcedDofs(const Machine& machine) {
  const MechanicalModel& model = machine.linear();
  const Index sensors = model.b.cols();
  std::vector<Index> dofs;
  for (Index dof = 0; dof < model.M.rows() && std::ssize(dofs) < sensors; ++dof) {
    const bool driven = !model.Gamma.row(dof).isZero(0.0);
    if (driven || sensors >= model.M.rows()) dofs.push_back(dof);
  }
  return dofs;
}

double FastestForce(const MeasuredRun& run) {
  return kFastest * MotionBandwidth(run) / (2.0 * std::numbers::pi * run.sample_time);
}

std::vector<MissingForce> MissingForces(const Machine& machine,
                                        const FilterPath& path) {
  const SmoothedForces smoothed = SmoothForces(path);
  const std::vector<std::string> names = CoordinateNames(machine.plant());
  std::vector<MissingForce> forces;
  for (std::size_t j = 0; j < path.dofs.size(); ++j) {
    const auto row = static_cast<Index>(j);
    const Index dof = path.dofs[j];
    MissingForce force;
    force.joint = names[static_cast<std::size_t>(dof)];
    force.unit = IsLength(machine.plant(), static_cast<int>(dof)) ? "N" : "N m";
    force.value = smoothed.value.row(row).transpose();
    force.rms = Rms(force.value);
    force.sd = smoothed.sd[row];
    force.memory = path.noise.memory[row];
    forces.push_back(std::move(force));
  }
  return forces;
}

}  // namespace mjdiag
