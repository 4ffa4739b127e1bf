#include "mjdiag/plugin/effects/site.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>
#include <set>

#include "mjdiag/plugin/plant/channels.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// (K + w^2 M)^-1 at a frequency far below all guides.
using Response = Eigen::LDLT<Eigen::MatrixXd>;

Response ResponseOf(const MechanicalModel& model) {
  constexpr double kOmega = 2.0 * std::numbers::pi * 5.0;  // [rad/s]
  return Response(model.K + kOmega * kOmega * model.M);
}

/// Of every joint, where a direction of forces moves it.
Eigen::VectorXd Work(const Response& response, const Eigen::VectorXd& direction) {
  return response.solve(direction).cwiseProduct(direction).cwiseAbs();
}

// A motor that pushes one stage from another strains stiff guides as well; the joint
// that gives way is the one that it drives, by the largest share of the work.
std::vector<Index> MostMoved(const MechanicalModel& model,
                             const Eigen::MatrixXd& directions) {
  const Response response = ResponseOf(model);
  std::vector<Index> joints(static_cast<std::size_t>(directions.cols()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Work(response, directions.col(static_cast<Index>(i))).maxCoeff(&joints[i]);
  }
  return joints;
}

/// Laws of a joint act on slides and hinges.
bool IsScalar(const mjModel& plant, Index dof) {
  const int type = plant.jnt_type[plant.dof_jntid[dof]];
  return type == mjJNT_SLIDE || type == mjJNT_HINGE;
}

std::vector<Index> Unique(const std::vector<Index>& joints) {
  const std::set<Index> set(joints.begin(), joints.end());
  return {set.begin(), set.end()};
}

}  // namespace

std::vector<Index> DrivenJoints(const MechanicalModel& model) {
  return MostMoved(model, model.Gamma);
}

std::vector<Index> SeenJoints(const MechanicalModel& model) {
  return MostMoved(model, model.b);
}

std::vector<Index> ToldJoints(const MechanicalModel& model) {
  constexpr double kTold = 0.01;  // of the work that a sensor's reading does
  const Response response = ResponseOf(model);
  std::vector<Index> joints;
  Eigen::VectorXd others = Eigen::VectorXd::Ones(model.M.rows());
  for (Index i = 0; i < model.b.cols(); ++i) {
    const Eigen::VectorXd all = model.b.col(i);
    if (all.isZero(0.0)) continue;  // it sees no motion, as one of forces
    const Eigen::VectorXd rest = all.cwiseProduct(others);
    Index joint = 0;
    const double most = Work(response, all).maxCoeff(&joint);
    if (others[joint] == 0.0 && Work(response, rest).maxCoeff(&joint) < kTold * most) {
      continue;
    }
    others[joint] = 0.0;
    joints.push_back(joint);
  }
  return joints;
}

SiteMap::SiteMap(const mjModel& plant, const MechanicalModel& model,
                 const Channels& channels, bool with_seen)
    : plant_(plant), model_(model), channels_(channels), driven_(DrivenJoints(model)) {
  if (with_seen) {
    std::ranges::copy(ToldJoints(model), std::back_inserter(driven_));
    // A load behind a shaft: nothing reads it, but it moves as far as what drives it.
    for (Index dof = 0; dof < plant.nv; ++dof) {
      if (IsScalar(plant, dof) && plant.jnt_stiffness[plant.dof_jntid[dof]] == 0.0) {
        driven_.push_back(dof);
      }
    }
  }
  driven_ = Unique(std::move(driven_));
}

std::vector<Site> SiteMap::Actuators() const {
  const std::vector<Index> driven = DrivenJoints(model_);
  std::vector<Site> sites;
  for (std::size_t u = 0; u < channels_.actuators.size(); ++u) {
    sites.push_back({channels_.actuators[u].element, driven[u], static_cast<Index>(u)});
  }
  return sites;
}

std::vector<Site> SiteMap::Sensors() const {
  const std::vector<Index> seen = SeenJoints(model_);
  std::vector<Site> sites;
  for (std::size_t y = 0; y < channels_.sensors.size(); ++y) {
    if (StageOf(plant_, channels_.sensors[y]) != mjSTAGE_POS) continue;  // no encoder
    sites.push_back({channels_.sensors[y].element, seen[y], static_cast<Index>(y)});
  }
  return sites;
}

std::vector<Site> SiteMap::Joints(const std::vector<Index>& joints) const {
  std::vector<Site> sites;
  sites.reserve(joints.size());
  for (const Index joint : joints) {
    if (!IsScalar(plant_, joint)) continue;
    sites.push_back({model_.coordinates[static_cast<std::size_t>(joint)], joint, -1});
  }
  return sites;
}

std::vector<Index> SiteMap::Held() const {
  std::vector<Index> joints;
  for (int j = 0; j < plant_.nv; ++j) {
    if (plant_.jnt_stiffness[plant_.dof_jntid[j]] > 0.0) joints.push_back(j);
  }
  return joints;
}

std::vector<Index> SiteMap::Ground() const {
  std::vector<Index> joints;
  for (Index j = 0; j < model_.M.rows(); ++j) {
    const int body = plant_.jnt_bodyid[plant_.dof_jntid[j]];
    if (plant_.body_parentid[body] == 0) joints.push_back(j);
  }
  return joints;
}

std::vector<Index> Without(std::vector<Index> joints,
                           const std::vector<Index>& others) {
  std::erase_if(joints, [&](Index j) { return std::ranges::count(others, j) > 0; });
  return joints;
}

}  // namespace mjdiag
