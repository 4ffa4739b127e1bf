#include "mjdiag/discovery/hypotheses/candidate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>
#include <set>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// A motor that pushes one stage from another strains stiff guides as well; the joint
// that gives way is the one that it drives: the largest share of the work at a
// frequency far below all guides, (K + w^2 M)^-1 d weighed with d, for every column d.
std::vector<Index> MostMoved(const MechanicalModel& model,
                             const Eigen::MatrixXd& directions) {
  constexpr double kOmega = 2.0 * std::numbers::pi * 5.0;  // [rad/s]
  const Eigen::MatrixXd work = (model.K + kOmega * kOmega * model.M)
                                   .ldlt()
                                   .solve(directions)
                                   .cwiseProduct(directions)
                                   .cwiseAbs();
  std::vector<Index> joints(static_cast<std::size_t>(directions.cols()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    work.col(static_cast<Index>(i)).maxCoeff(&joints[i]);
  }
  return joints;
}

/// Joints of bodies that stand on the world.
std::vector<Index> GroundJoints(const mjModel& plant, const MechanicalModel& model) {
  std::vector<Index> joints;
  for (Index j = 0; j < model.M.rows(); ++j) {
    const int body = plant.jnt_bodyid[plant.dof_jntid[j]];
    if (plant.body_parentid[body] == 0) joints.push_back(j);
  }
  return joints;
}

std::vector<Index> HeldJoints(const mjModel& plant) {
  std::vector<Index> joints;
  for (int j = 0; j < plant.nv; ++j) {
    if (plant.jnt_stiffness[plant.dof_jntid[j]] > 0.0) joints.push_back(j);
  }
  return joints;
}

std::vector<Index> Without(std::vector<Index> joints,
                           const std::vector<Index>& others) {
  std::erase_if(joints, [&](Index j) { return std::ranges::count(others, j) > 0; });
  return joints;
}

std::vector<Index> Unique(const std::vector<Index>& joints) {
  const std::set<Index> set(joints.begin(), joints.end());
  return {set.begin(), set.end()};
}

/// What the plant itself has to be left with: no damping or mass below zero.
double LowerBound(const mjModel& plant, const EffectSpec& spec,
                  const EffectParameter& parameter, Index joint) {
  const int dof = static_cast<int>(joint);
  if (spec.effect == "viscous_friction" ||
      spec.effect == "asymmetric_viscous_friction") {
    return -plant.dof_damping[dof];
  }
  if (spec.effect == "added_mass") {
    const int id = plant.dof_jntid[dof];
    const double mass = plant.jnt_type[id] == mjJNT_HINGE
                            ? plant.dof_M0[dof]
                            : plant.body_mass[plant.jnt_bodyid[id]];
    return -0.9 * mass;
  }
  return parameter.minimum;
}

Candidate MakeCandidate(const mjModel& plant, const EffectType& type,
                        const std::string& site, Index joint, Index channel) {
  Candidate candidate;
  candidate.cause.spec = {type.name, site, {}};
  candidate.joint = joint;
  candidate.channel = channel;
  for (const EffectParameter& p : type.parameters) {
    candidate.parameters.push_back(
        {p.name, LowerBound(plant, candidate.cause.spec, p, joint), p.maximum});
  }
  return candidate;
}

/// The joints at which an effect is a candidate.
std::vector<Index> JointSites(const mjModel& plant, const MechanicalModel& model,
                              const EffectType& type) {
  const std::vector<Index> driven = Unique(DrivenJoints(model));
  const std::vector<Index> held = HeldJoints(plant);
  if (type.site == EffectSite::kHeldJoint) return held;
  if (type.name == "floor_vibration") {
    const std::vector<Index> ground = GroundJoints(plant, model);
    const std::vector<Index> passive = Without(ground, driven);
    return passive.empty() ? ground : passive;
  }
  if (type.name == "linear_stiffness") return Without(driven, held);
  return driven;
}

std::vector<Candidate> KnobCandidates(const Machine& machine) {
  const MechanicalModel& model = machine.linear();
  std::vector<Candidate> candidates;
  for (const FaultKnob& knob : FaultKnobs(machine.plant())) {
    Candidate candidate;
    candidate.cause = KnobCause(machine.plant(), knob);
    candidate.parameters = {{"value", 0.0, 100.0}};
    const int element = knob.elements.front();
    if (knob.kind == KnobKind::kGear) {
      const std::string name = ElementName(machine.plant(), mjOBJ_ACTUATOR, element);
      const auto place = std::ranges::find(machine.channels().actuators, name,
                                           &ActuatorSetup::element);
      if (place == machine.channels().actuators.end()) continue;
      candidate.channel = place - machine.channels().actuators.begin();
      candidate.joint =
          DrivenJoints(model)[static_cast<std::size_t>(candidate.channel)];
    } else {
      candidate.joint = machine.plant().jnt_dofadr[element];
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

}  // namespace

std::string Describe(const Candidate& candidate) {
  const EffectSpec& spec = candidate.cause.spec;
  return candidate.cause.fault ? spec.effect : spec.effect + "@" + spec.site;
}

std::vector<Index> DrivenJoints(const MechanicalModel& model) {
  return MostMoved(model, model.Gamma);
}

std::vector<Index> SeenJoints(const MechanicalModel& model) {
  return MostMoved(model, model.b);
}

std::vector<Candidate> AllSites(const Machine& machine) {
  const MechanicalModel& model = machine.linear();
  std::vector<Candidate> candidates = KnobCandidates(machine);
  const std::vector<Index> driven = DrivenJoints(model);
  const std::vector<Index> seen = SeenJoints(model);
  const auto add = [&](Candidate candidate) {
    candidates.push_back(std::move(candidate));
  };
  for (const EffectType& type : EffectCatalogue()) {
    if (type.name == "encoder_noise") continue;
    if (type.site == EffectSite::kActuator) {
      for (std::size_t u = 0; u < machine.channels().actuators.size(); ++u) {
        add(MakeCandidate(machine.plant(), type,
                          machine.channels().actuators[u].element, driven[u],
                          static_cast<Index>(u)));
      }
    } else if (type.site == EffectSite::kSensor) {
      for (std::size_t y = 0; y < machine.channels().sensors.size(); ++y) {
        add(MakeCandidate(machine.plant(), type, machine.channels().sensors[y].element,
                          seen[y], static_cast<Index>(y)));
      }
    } else {
      for (const Index joint : JointSites(machine.plant(), model, type)) {
        add(MakeCandidate(machine.plant(), type,
                          model.coordinates[static_cast<std::size_t>(joint)], joint,
                          -1));
      }
    }
  }
  return candidates;
}

std::vector<Candidate> ListCandidates(const Machine& machine) {
  std::vector<Candidate> candidates = AllSites(machine);
  const std::vector<Candidate> all = candidates;
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return !candidate.cause.fault &&
           std::ranges::any_of(all, [&](const Candidate& knob) {
             return knob.cause.fault &&
                    Indistinguishable(machine.plant(), knob.cause, candidate.cause);
           });
  });
  return candidates;
}

}  // namespace mjdiag
