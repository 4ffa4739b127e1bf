#pragma once
// Candidate causes of a machine: which fault parameters and effects, at which sites,
// could be what a simulation lacks.
//
// An effect is a candidate where it makes sense physically, which it says itself
// (Effect::CandidateSites). Fault parameters come first; an effect that no measurement
// can tell from one (Indistinguishable) is left to it.

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/effects/role.h"
#include "mjdiag/plugin/effects/site.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// A parameter that a fit may change.
struct FitParameter {
  std::string name;
  Role role = Role::kAmplitude;
  double lower = 0.0;
  double upper = 0.0;
  /// Where it does nothing, and how far from there it is expected, a standard deviation;
  /// infinite: anywhere.
  double nothing = 0.0;
  double spread = std::numeric_limits<double>::infinity();
  /// How far from `nothing` it is at least: less is not told from nothing.
  double least_size = 0.0;
  /// Of the period of a wave, the stroke that it goes through; of its frequency, the time:
  /// what tells it from its neighbours. 0 of anything else.
  double extent = 0.0;
  /// Of the period of a wave: longer than one go, so that none is seen come round, and shorter
  /// than two gaps between goes, so that other periods look like it (Nyquist).
  double unseen_from = 0.0;
  double unseen_to = 0.0;
  bool IsSeen(double value) const { return value <= unseen_from || value >= unseen_to; }
};

/// An effect and where it acts, without values.
struct Candidate {
  EffectPtr effect;
  std::string site;
  Eigen::Index joint = 0;     ///< see Site
  Eigen::Index channel = -1;  ///< see Site
  std::vector<FitParameter> parameters;
  /// Of effects with choices (Role::kChoice), which come first: their values. Parameters
  /// of the effect behind `parameters` are 0.
  Eigen::VectorXd chosen = {};
};

/// Place of the first parameter with that role; the number of parameters if there is
/// none.
Eigen::Index PlaceOf(const Candidate& candidate, Role role);

/// Place of its period or frequency, the same.
Eigen::Index PeriodPlace(const Candidate& candidate);

/// "coulomb_friction@X", "zeta_x".
std::string CandidateName(const Candidate& candidate);

/// @param with_seen  at joints that are only seen, too
std::vector<Candidate> ListCandidates(const Machine& machine, bool with_seen = false);

/// The same with those effects that a fault parameter stands for.
std::vector<Candidate> AllSites(const Machine& machine, bool with_seen = false);

}  // namespace mjdiag
