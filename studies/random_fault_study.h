#pragma once
// Whether a machine's twin names the right faults, whatever they are and whenever the
// record begins: one to three faults of random sizes, and none in a fifth of the runs.

#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/random_fault.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// A fault nearer to healthy than this many standard deviations of its information bound
/// (run_bound.h, all faults unknown) need not be named, and may be: naming asks for 4.4
/// of them of a parameter and 5.9 of a disturbance of three tones, which an estimate at
/// the bound reaches from here on in at least nineteen of twenty runs, for a disturbance
/// in three of four.
inline constexpr double kNameable = 6.0;

/// What became of a draw.
struct RandomOutcome {
  RandomDraw draw;
  bool diverged = false;  ///< the machine did, under those faults: nothing else is said
  Eigen::VectorXd truth;  ///< deviations from healthy, nf
  Eigen::VectorXd bound;  ///< standard deviations, nf
  TwinReading reading;

  bool Present(Eigen::Index fault) const { return truth[fault] != 0.0; }
  bool Nameable(Eigen::Index fault) const;
  bool Missed(Eigen::Index fault) const;  ///< nameable and not named
  bool False(Eigen::Index fault) const;   ///< named and not there
  /// Nothing missed and nothing false.
  bool Right() const;
};

/// One run of the plan's plant, diagnosed by the healthy machine's twin.
RandomOutcome TryDraw(const LoadedPlan& loaded, const RunMaker& maker,
                      const RandomDraw& draw);

/// Draws (random_fault.h) of the plan's case, as many as it has points: every run, how often
/// the names were right with the interval of that probability, false alarms, and errors
/// over the standard deviations that were claimed and over the bound.
std::vector<StudyTable> AnswerTo(const AskNames& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
