#pragma once
// The one door to all studies: what a plan asks (plan_ask.h), answered in tables.

#include <vector>

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// InputError of a plan that asks nothing.
std::vector<StudyTable> AnswerTo(const LoadedPlan& plan, const StudyOptions& options);

// The same, question by question; how each is answered is in the file of its study.

/// Bound alone and together, the standard deviation of the estimators with one residual
/// and with all of them, and their multiples of the bound; of the plan's first motion.
std::vector<StudyTable> AnswerTo(const AskBound& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// Of every point of the plan: tones found with their frequencies, the magnitude
/// estimated, and whether noise was called raised, over its replications.
std::vector<StudyTable> AnswerTo(const AskDisturbances& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// For every point of the plan: mean estimate over its replications, largest error as a
/// share of the deviation, standard deviation claimed and found, how often the 95 %
/// interval held the truth with the binomial 99 % band of that count, and the multiple of
/// the information bound. Every fault parameter and disturbance is estimated, by the twin
/// of the machine (twin_estimator.h).
std::vector<StudyTable> AnswerTo(const AskEstimates& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// By every judge: on the linear plant with the limits of the setup from nominal runs, on
/// the nonlinear one from nominal runs of the motion; `baseline` subtracts the residuals'
/// baseline of the same motion. The robust residual of a fault looks for that one alone.
std::vector<StudyTable> AnswerTo(const AskSmallestSize& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// Draws (random_fault_study.h) of the plan's case, as many as it has points: every run, how
/// often the names were right with the interval of that probability, false alarms, and
/// errors over the standard deviations that were claimed and over the bound.
std::vector<StudyTable> AnswerTo(const AskNames& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// For every case of the plan single faults, one axis after the other, each with a range on
/// one side of healthy in which sizes are even in their logarithm, and as many healthy runs
/// between them; half of the runs train the support vector machines, the other half is
/// judged by all methods. A case has as many runs as points. The residual-based method
/// detects by thresholds and spectrum and names the fault whose estimate is most
/// significant; the twin has to name the one fault and no other. Neither is trained.
std::vector<StudyTable> AnswerTo(const AskClasses& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// A machine for every replication of the plan. Logarithms of all numbers are drawn with the
/// standard deviations that they have without measuring (UsualSpread).
std::vector<StudyTable> AnswerTo(const AskCalibration& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// What is wrong at every point of the plan, from a third of the motion on, on either
/// plant; what is wrong at an earlier point, too, counts once.
std::vector<StudyTable> AnswerTo(const AskTolerance& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// The run of `duration` on the plan's plant, a row for every `every`; faults of `wear`
/// grow evenly from healthy. What the twin says is looked at every tenth of a second, and a
/// row says all that it said since the last one. InputError on a wear of what is no fault
/// parameter of the plant.
std::vector<StudyTable> AnswerTo(const AskEndurance& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

/// A case for every replication of the plan, seeds from its own on.
std::vector<StudyTable> AnswerTo(const AskHidden& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
