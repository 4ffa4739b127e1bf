#include "mjdiag/diagnosis/model/linear_chain.h"

#include <Eigen/Geometry>
#include <map>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// The joints of the whole tree in one row, and for every body the columns of the
/// joints that carry it, from the world outwards.
class Kinematics {
 public:
  explicit Kinematics(const LinearChain& chain) {
    for (const ChainBody& body : chain.bodies) {
      std::vector<Index> path = PathOf(body.parent, "body " + body.name);
      for (const ChainJoint& joint : body.joints) {
        path.push_back(static_cast<Index>(joints_.size()));
        joints_.push_back(joint);
      }
      paths_[body.name] = path;
    }
  }

  const std::vector<ChainJoint>& joints() const { return joints_; }
  Index size() const { return static_cast<Index>(joints_.size()); }

  /// Columns of the joints that carry a body; none for the world.
  std::vector<Index> PathOf(const std::string& body, const std::string& user) const {
    if (body.empty()) return {};
    const auto found = paths_.find(body);
    if (found == paths_.end()) {
      throw InputError(user, "unknown body \"" + body + "\"",
                       "a body that stands before it");
    }
    return found->second;
  }

  /// Velocity of a point that moves with joint j, per joint speed.
  Vector3d Velocity(Index j, const Vector3d& point) const {
    const ChainJoint& joint = joints_[static_cast<std::size_t>(j)];
    return joint.hinge ? joint.axis.cross(point - joint.point) : joint.axis;
  }
  /// Angular velocity of what joint j carries, per joint speed.
  Vector3d Rotation(Index j) const {
    const ChainJoint& joint = joints_[static_cast<std::size_t>(j)];
    return joint.hinge ? joint.axis : Vector3d::Zero();
  }

 private:
  std::vector<ChainJoint> joints_;
  std::map<std::string, std::vector<Index>> paths_;
};

MatrixXd MassMatrix(const LinearChain& chain, const Kinematics& kinematics) {
  MatrixXd mass = MatrixXd::Zero(kinematics.size(), kinematics.size());
  for (const ChainBody& body : chain.bodies) {
    const std::vector<Index> path = kinematics.PathOf(body.name, body.name);
    for (const Index i : path) {
      for (const Index j : path) {
        mass(i, j) += body.mass * kinematics.Velocity(i, body.centre)
                                      .dot(kinematics.Velocity(j, body.centre)) +
                      kinematics.Rotation(i).dot(
                          body.inertia.cwiseProduct(kinematics.Rotation(j)));
      }
    }
  }
  return mass;
}

/// Second derivative of the potential energy sum_b m_b g z_b in the reference
/// configuration. A joint i turns everything outside it, the velocity that an outer
/// joint j gives to a centre of mass included, so for i at or inside j
///   d^2 c / dq_i dq_j = w_i x (dc / dq_j),
/// with w_i the axis of a hinge and zero for a slide.
MatrixXd GravityStiffness(const LinearChain& chain, const Kinematics& kinematics) {
  MatrixXd stiffness = MatrixXd::Zero(kinematics.size(), kinematics.size());
  for (const ChainBody& body : chain.bodies) {
    const std::vector<Index> path = kinematics.PathOf(body.name, body.name);
    for (std::size_t outer = 0; outer < path.size(); ++outer) {
      const Vector3d velocity = kinematics.Velocity(path[outer], body.centre);
      for (std::size_t inner = 0; inner <= outer; ++inner) {
        const double curvature = body.mass * chain.gravity *
                                 kinematics.Rotation(path[inner]).cross(velocity).z();
        stiffness(path[inner], path[outer]) += curvature;
        if (inner != outer) stiffness(path[outer], path[inner]) += curvature;
      }
    }
  }
  return stiffness;
}

/// How the port's body moves against its base, per joint speed: also, by virtual work,
/// the generalised force of its force pair.
Eigen::VectorXd PortColumn(const ChainPort& port, const Kinematics& kinematics) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(kinematics.size());
  const auto add = [&](const std::string& body, double sign) {
    for (const Index j : kinematics.PathOf(body, "port " + port.name)) {
      const Vector3d motion =
          port.rotational ? kinematics.Rotation(j) : kinematics.Velocity(j, port.point);
      column[j] += sign * port.gain * port.axis.dot(motion);
    }
  };
  add(port.body, 1.0);
  add(port.base, -1.0);
  return column;
}

MatrixXd PortMatrix(const std::vector<ChainPort>& ports, const Kinematics& kinematics,
                    std::vector<std::string>& names) {
  MatrixXd matrix(kinematics.size(), static_cast<Index>(ports.size()));
  for (std::size_t i = 0; i < ports.size(); ++i) {
    matrix.col(static_cast<Index>(i)) = PortColumn(ports[i], kinematics);
    names.push_back(ports[i].name);
  }
  return matrix;
}

}  // namespace

MechanicalModel Linearize(const LinearChain& chain) {
  const Kinematics kinematics(chain);
  MechanicalModel model;
  model.M = MassMatrix(chain, kinematics);
  model.D = MatrixXd::Zero(kinematics.size(), kinematics.size());
  model.K = GravityStiffness(chain, kinematics);
  for (Index j = 0; j < kinematics.size(); ++j) {
    const ChainJoint& joint = kinematics.joints()[static_cast<std::size_t>(j)];
    model.coordinates.push_back(joint.name);
    model.D(j, j) = joint.damping;
    model.K(j, j) += joint.stiffness;
  }
  model.Gamma = PortMatrix(chain.actuators, kinematics, model.inputs);
  model.b = PortMatrix(chain.sensors, kinematics, model.outputs);
  return model;
}

}  // namespace mjdiag
