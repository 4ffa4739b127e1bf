#pragma once
// The parts of a discovery (discovery.h) while it is under way: the search in
// discovery.cc, sets of causes in discovery_sets.cc, laws along the motion in
// discovery_forces.cc, the last fits in discovery_last_fit.cc, what has no name in
// discovery_curves.cc, the answer in discovery_answer.cc and discovery_kinds.cc, notes in
// discovery_notes.cc, figures in discovery_figures.cc.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/fitting/profile_interval.h"
#include "mjdiag/discovery/forces/force_search.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/candidate_choice.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/hypotheses/work.h"
#include "mjdiag/discovery/law.h"
#include "mjdiag/discovery/screening/trial.h"
#include "mjdiag/discovery/selection/search.h"
#include "mjdiag/discovery/unexplained/motion_variables.h"
#include "mjdiag/discovery/unexplained/unknown_input.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// A discovery under way.
class Discoverer {
 public:
  Discoverer(const Machine& machine, Measurements measurements,
             const DiscoverOptions& options)
      : machine_(machine),
        measurements_(std::move(measurements)),
        options_(options),
        work_(std::make_shared<Work>(options.budget, options.stop)),
        candidates_(ChooseCandidates(machine, options.choice)),
        problem_(Pose(options.bandwidth)) {}

  Discovery Run();

 private:
  DiscoveryProblem Pose(double bandwidth) const;
  void Report(const std::string& what, double fraction, const CauseFit& best) const;
  void MeasureSpeed();
  void Report(const std::string& what, double fraction) const {
    Report(what, fraction, search_.fit());
  }
  bool IsColoured(const CauseFit& fit) const;
  /// Whether what the present set leaves is the noise of the sensors, and how probably.
  double ProbabilityThatNoiseIsLeft() const;
  void Search(const DiscoveryProblem& problem, SearchOptions options,
              bool down_to_noise);
  void SearchBeginning(SearchOptions options);
  void SearchBehindObservers(SearchOptions options);
  /// True if sets of causes were found that nothing has to be added to; search_ goes on
  /// from them.
  bool TakeSets(const SearchOptions& search);
  /// Goes on in that many physics steps a tick.
  void TakeSubsteps(int substeps);
  /// Whether it is a machine that falls, behind no observer that was asked for.
  bool GoesAlongMotion() const { return falls_ && options_.bandwidth == 0.0; }
  /// Laws along its motion; true if there is nothing to add.
  bool TakeForces(const SearchOptions& search);
  /// As closely as possible, behind the observer that they deserve.
  void FitSets(const SearchOptions& options);
  std::vector<PlantNumber> KnownNumbers() const;
  /// FreeRun of the records that no fit sees.
  double UnseenFree(const Changes& changes) const;
  void SearchAll();
  /// Discovery::complete. Where a force without a name, or a law at its end, is among the
  /// causes it is 0.
  double Completeness() const;
  void NoteIncompleteness();
  void MeasureNominal();
  void CompleteJacobian();
  void FitFree();
  void TakeFree(const DiscoveryProblem& free, CauseFit fit);
  std::optional<std::size_t> EmptyCause(std::vector<Interval>& intervals) const;
  double LossByChance(std::size_t cause) const;
  void TryToLeaveOut(std::size_t cause);
  void DropEmptyCauses();
  std::vector<Interval> QuadraticIntervals() const;
  void NoteBudget();
  void NameCauses();
  Kind KindOfCause(const FittedCause& fitted) const;
  std::vector<FoundKind> KindsAt(const std::vector<std::size_t>& places, double needed,
                                 double share) const;
  void AddKind(FoundKind kind);
  void FindKinds();
  void FindKindsBehindObserver();
  void FindKindsAlongMotion();
  void AddKindsOfNumbers();
  std::vector<CauseParameter> DescribeParameters(const FittedCause& fitted,
                                                 const Eigen::MatrixXd& covariance,
                                                 const std::vector<Interval>& intervals,
                                                 Eigen::Index first) const;
  /// Of a learned curve.
  bool IsActive(const FittedCause& curve, const FoundCause& found) const;
  std::vector<Alternative> AlternativesOf(const FittedCause& fitted,
                                          const std::vector<Hypothesis>& rivals) const;
  void NameNumbers(const Eigen::MatrixXd& covariance);
  void NameMoments(const Eigen::MatrixXd& covariance);
  void AddNoiseCauses(const Eigen::MatrixXd& innovations);
  void Judge();
  /// Whether a cause is no more than what the physics steps of the simulation are off by.
  bool IsOfSteps(const FittedCause& fitted) const;
  void NoteLateness(double delay);
  void NoteFarNumbers();
  void NoteQuietAxes(const ObservedMotion& motion);
  void NoteTwins(std::size_t cause);
  std::vector<UnknownSignal> UnexplainedIn(const Track& track,
                                           const Changes& changes) const;
  void FindWhere(const Track& nominal, const Track& final);
  /// What the largest of the forces that nothing explains depends on; asked of all that
  /// the machine does, or of what a curve may be over.
  struct Rest {
    UnknownSignal force;
    Eigen::Index joint = 0;  ///< nv
    std::vector<MotionVariable> variables;
    Signature signature;
  };
  Rest SignatureOf(const ObservedMotion& motion,
                   const std::vector<UnknownSignal>& forces, bool for_curve) const;
  void SignRest(const ObservedMotion& motion);
  bool LearnCurve(const EvidenceData& data, const FittedModel& base);
  void Take(Evidence with_force);
  std::vector<FittedModel> WithoutAlike() const;
  std::vector<FittedModel> WithoutDoubtful() const;
  void LearnCurves(const SearchOptions& options);
  LawPlot PlotLaw(const ObservedMotion& motion, std::size_t cause) const;
  void AddLaws(const ObservedMotion& motion);
  void AddLadder();
  void AddComparisons();
  void AddLimits();

  Machine machine_;
  Measurements measurements_;
  const DiscoverOptions& options_;
  std::shared_ptr<Work> work_;
  std::vector<Candidate> candidates_;
  DiscoveryProblem problem_;
  /// Of the machine as given, made when first asked for.
  mutable std::optional<FilterPath> filter_;
  bool falls_ = false;  ///< without a controller that nobody knows (comparison.h)
  double most_seconds_ = 0.0;  // of this machine, that the budget takes; for people
  double nominal_ = 0.0;  // mean square of the plant as given, behind this observer
  SearchResult search_;
  /// Of a machine that leaves its rest.
  std::optional<ForceSearchResult> force_;
  /// The last fit, where it is one of free simulation or of forces along the motion, with
  /// its problem.
  std::optional<std::pair<DiscoveryProblem, CauseFit>> free_fit_;
  /// Of causes that are needed though they may be nothing to first order, by candidate:
  /// squared innovations that there are more of without them.
  std::map<std::size_t, double> losses_;
  /// Of every cause that is named, its place in the last fit.
  std::vector<std::size_t> named_;
  const CauseFit& LastFit() const {
    return free_fit_ ? free_fit_->second : search_.fit();
  }
  const DiscoveryProblem& LastProblem() const {
    return free_fit_ ? free_fit_->first : problem_;
  }
  /// Of what was learned, by candidate.
  struct CurveText {
    std::string words;
    LawAxis axis;
  };
  std::map<std::size_t, CurveText> curves_;
  Changes changes_;
  Discovery discovery_;
};

}  // namespace mjdiag
