#pragma once
// Candidate causes of a machine: which fault knobs and effects, at which sites, could
// be what a simulation lacks.
//
// An effect of the catalogue is a candidate where it makes sense physically: friction,
// ripple, offsets, stops and masses at the joints that an actuator moves, springs that
// are wrong or loose at the joints that have one, vibration of the floor at the joints
// that stand on it, drive effects at the actuators and encoder errors at the sensors of
// the setup. Knobs come first; an effect that no measurement can tell from a knob
// (Indistinguishable) is left to it. White encoder noise is not among the candidates:
// it shows in the variance of the innovations, not in their course (sensor_noise.h).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/mechanical_model.h"
#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// A parameter that a fit may change.
struct FitParameter {
  std::string name;
  double lower = 0.0;
  double upper = 0.0;
};

struct Candidate {
  Cause cause;  ///< without values
  std::vector<FitParameter> parameters;
  /// Joint that the cause acts on most, for signatures and plots; of an encoder error
  /// the joint that its sensor sees; nq index.
  Eigen::Index joint = 0;
  /// Its place among the setup's actuators or sensors, if it acts there; else -1.
  Eigen::Index channel = -1;
};

/// "coulomb_friction@X", "zeta_x".
std::string Describe(const Candidate& candidate);

/// The joint (nq index) that every actuator of the setup moves most, and the one that
/// every sensor sees most.
std::vector<Eigen::Index> DrivenJoints(const MechanicalModel& model);
std::vector<Eigen::Index> SeenJoints(const MechanicalModel& model);

std::vector<Candidate> ListCandidates(const Machine& machine);

/// The same with those effects that a knob stands for.
std::vector<Candidate> AllSites(const Machine& machine);

}  // namespace mjdiag
