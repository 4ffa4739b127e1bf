#pragma once
// From a measured record to causes: what the simulation gets wrong, where it acts, why,
// and what is gained by putting it in. The whole job, from the record to the figures
// that tables, JSON and pages are made of.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/comparison/disturbance_estimate.h"
#include "mjdiag/discovery/fit/decision.h"
#include "mjdiag/discovery/hypotheses/candidate_choice.h"
#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/discovery/measurements.h"
#include "mjdiag/discovery/record_replay.h"
#include "mjdiag/discovery/residual_dependence/residual_dependence.h"
#include "mjdiag/discovery/verdict.h"
#include "mjdiag/plugin/effects/kind.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct CauseParameter {
  std::string name;
  std::string unit;  ///< SI
  double value = 0.0;
  double sd = 0.0;
  double low = 0.0;  ///< 95 % interval
  double high = 0.0;
};

/// A number of the plant as the record has it.
struct CalibratedNumber {
  std::string name;  ///< "mass@stage"
  ModelParameter number;
  double factor = 1.0;  ///< of what the model says
  double low = 1.0;     ///< 95 % interval
  double high = 1.0;
  /// Standard deviation of its logarithm as far as was known before the record.
  double doubt = 0.0;
  /// Of a centre of mass or a reference, which is no factor: by how far it moves with ln
  /// factor; else 0.
  double shift = 0.0;
  std::string shift_unit{};  ///< "m" or "rad"
  /// The answer has it as one of the things that are wrong.
  bool is_found = false;
};

/// What motion tells of masses and of where they are, together (mass_moments.h) [kg m].
struct CalibratedMoment {
  std::string joint;
  std::string axis;    ///< of the frame of the body that it turns
  double model = 0.0;  ///< as the model has it
  double value = 0.0;  ///< as the record has it
  double low = 0.0;    ///< 95 % interval
  double high = 0.0;
  double doubt = 0.0;  ///< standard deviation as far as was known before the record
};

/// What the members of an answer that resist a joint do there together (resistances.h).
struct FoundResistance {
  std::string site;  ///< the joint
  bool is_turning = false;
  std::vector<std::string> members;
  struct Span {
    double value = 0.0;
    double low = 0.0;  ///< 95 % interval
    double high = 0.0;
  };
  Span dry;      ///< [N, N m]
  Span viscous;  ///< [N s/m, N m s/rad]
  /// Resistance at speeds along the motion, and half of its 95 % interval.
  Eigen::VectorXd speeds;  ///< [m/s, rad/s]
  Eigen::VectorXd force;   ///< [N, N m]
  Eigen::VectorXd half;

  std::string ForceUnit() const { return is_turning ? "N m" : "N"; }
  std::string SpeedUnit() const { return is_turning ? "rad/s" : "m/s"; }
  std::string ViscousUnit() const { return is_turning ? "N m s/rad" : "N s/m"; }
};

struct Alternative {
  Cause cause;
  double probability = 0.0;
  bool indistinguishable = false;  ///< no measurement tells them apart
};

struct FoundCause {
  Cause cause;
  std::vector<CauseParameter> parameters;
  double probability = 0.0;               ///< among all candidates for its place
  std::vector<Alternative> alternatives;  ///< of 1 % or more, likeliest first
  /// A number of the plant that could be another one in its place.
  struct NumberInstead {
    std::string name;  ///< "mass@stage"
    double probability = 0.0;
  };
  std::vector<NumberInstead> numbers = {};  ///< the same
  double none = 0.0;                        ///< that nothing is in its place
  /// Of a force that was learned and has no name, what it is in words; else empty.
  std::string unnamed = {};
  bool HasName() const { return unnamed.empty(); }
};

/// A kind of physics at a place: what people can act on before a law has a name.
struct FoundKind {
  Kind kind = Kind::kUnknownForce;
  std::string site;
  /// That it is this kind there, whichever of its laws: the sum of the laws' shares of one
  /// posterior (answer/posterior.h).
  double probability = 0.0;
  /// Of the unseen mismatch that the answer takes away, what is back without it.
  double share = 0.0;
  /// A number of the plant that is another one, no cause.
  bool of_number = false;
};

/// After each cause that was added; the first step is the plant as it was given.
struct LadderStep {
  std::string added;  ///< "nothing", "coulomb_friction@load", "zeta_x"
  /// Innovations over sensor noise, root mean square; 1: noise is all there is.
  double train = 0.0;
  double held_out = 0.0;
  /// Closed-loop or input replay: relative error of channels and derived signals [%].
  std::map<std::string, double> error_percent;
  std::map<std::string, double> validation_percent;  ///< empty without such a record
};

/// A found law over what it depends on: the force that the plant with all other causes
/// leaves unexplained (partial residuals), as points, and the law as a curve.
struct LawPlot {
  std::string cause;
  std::string site;
  std::string x_name;  ///< for example "velocity"
  std::string x_unit;
  std::string y_unit;
  Eigen::VectorXd x, y;          ///< points
  Eigen::VectorXd law_x, law_y;  ///< curve, x increasing
};

/// The smallest size of a fault that the mismatch of the healthy machine does not
/// hide, as a change of the fault parameter.
struct FaultLimit {
  std::string fault;
  double before = 0.0;  ///< with the plant as it was given
  double after = 0.0;   ///< with the extended plant
};

/// Without a budget a discovery ends when it is done.
inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// What a discovery did, in seconds.
struct Budget {
  double used = 0.0;
  double limit = kUnlimited;
  bool stopped = false;               ///< it was asked to end
  std::vector<std::string> left_out;  ///< what it did not come to
};

/// A discovery under way, for people.
struct DiscoveryProgress {
  std::string what;           ///< is being tried
  double fraction = 0.0;      ///< of a round that is done
  std::string best;           ///< "coulomb_friction@load (mismatch 100 % to 7 %)"
  double most_seconds = 0.0;  ///< the budget
};

struct Discovery {
  std::string setup;                ///< its name
  std::vector<Decision> decisions;  ///< what was tried, in that order
  DiscoveryVerdict verdict = DiscoveryVerdict::kNoDiscrepancy;
  std::vector<FoundCause> causes;
  std::vector<FoundKind> kinds;  ///< the most probable first, certain ones by share
  /// Share of the force that was missing which is left, rms along data that no fit saw;
  /// none: no more than noise is left, or nothing was found.
  std::optional<double> force_left;
  /// All numbers of the plant that were in doubt, as they are beside the causes.
  std::vector<CalibratedNumber> calibration;
  /// Of machines with hinges, what the record tells of masses and their places together.
  std::vector<CalibratedMoment> moments;
  /// Of every joint that more than one law of one size resists.
  std::vector<FoundResistance> resistances;
  std::optional<ResidualDependence> unexplained;  ///< of what is left, if anything is
  std::string unexplained_site;
  /// What cannot be judged, what cannot be told apart and which experiment would,
  /// what looks odd in the record.
  std::vector<std::string> notes;

  double train_share = 0.0;  ///< of what may be fitted that fits saw
  /// Of every record; those that fits saw first.
  std::vector<RecordReplay> records;
  /// The first that they saw, and the first that they did not; null if there is none.
  const RecordReplay* Fitted() const;
  const RecordReplay* Unseen() const;
  /// rms of the mismatch per channel: on what fits saw, and on what they did not see (the
  /// validation records if there are any, else the rest of the record).
  struct Figures {
    std::map<std::string, double> train;
    std::map<std::string, double> validation;
  };
  /// Where no free simulation says anything, the mismatch is that of predictions over so
  /// long from the filtered motion [s]; 0: of free simulation.
  double horizon = 0.0;
  Figures mismatch_before;
  Figures mismatch_after;
  std::map<std::string, double> noise_floor;
  std::map<std::string, std::string> unit;  ///< of the channels
  /// 1 - after / before of the root mean square of mismatch over noise floor of all
  /// channels.
  double gain_train = 0.0;
  double gain_validation = 0.0;
  /// Share of the innovations' power that is not white, before and after: 0 white.
  double colour_before = 0.0;
  double colour_after = 0.0;

  std::vector<LadderStep> ladder;
  std::vector<DisturbanceEstimate>
      forces_before;  ///< unexplained, at the driven joints
  std::vector<DisturbanceEstimate> forces_after;
  std::vector<LawPlot> laws;
  std::vector<FaultLimit> fault_limits;
  double sample_time = 0.0;
  /// Physics steps a control tick that the answer is said of: those of the setup, or more
  /// where the record tells that they are too few. 0 of an answer that is not made yet.
  int substeps = 0;
  Budget budget;
};

struct DiscoverOptions {
  double train_share = 0.7;
  std::optional<int> most_causes;  ///< none: 8 for every degree of freedom
  /// Numbers of the plant are not taken as true: they may be what is wrong, as far as they
  /// are not known beforehand (DoubtOf).
  bool doubt = false;
  /// Those that are as the plant says all the same: "all", a kind ("mass") or one
  /// ("mass@stage").
  std::vector<std::string> known;
  bool figures = true;  ///< comparisons, ladder, laws and limits, not only causes
  std::uint64_t seed = 1;
  /// Causes that may be named: all but for these choices.
  CandidateChoice choice;
  /// Seconds after which a discovery ends with the best answer so far.
  double budget = kUnlimited;
  /// Whether it is asked to do so at once; called from any thread. May be empty.
  std::function<bool()> stop;
  std::function<void(const DiscoveryProgress& progress)> progress;
};

/// By one engine for every machine: a filter with latent forces, one regression and fits with
/// MuJoCo's own ticks (fit/explain.h), and a judgement by data that no fit saw (answer/).
/// Without validation records that is the end of every record.
/// @param machine  the nominal one
/// InputError if the record lacks what the replay needs or cannot be judged (see
/// data_check.h), and on a choice that means nothing (candidate_choice.h).
Discovery Discover(const Machine& machine, const Measurements& measurements,
                   const DiscoverOptions& options);
/// @param validation  a record of another motion that nothing is fitted to, or null
Discovery Discover(const Machine& machine, const Record& measured,
                   const Record* validation, const DiscoverOptions& options);

/// Whether the record says of a number that it is another one than the model has.
bool IsOff(const CalibratedNumber& number);
bool IsMoved(const CalibratedMoment& moment);

/// Whether anything was found that the plant does not say: causes, or numbers of it.
bool HasFound(const Discovery& discovery);

/// The causes and the numbers as changes to a plant, for Simulate and ExtendMjcf.
Changes ChangesOfAnswer(const Discovery& discovery);

}  // namespace mjdiag
