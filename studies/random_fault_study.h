#pragma once
// Whether a machine's twin names the right faults, whatever they are and whenever the
// record begins: one to three faults of random sizes, and none in a fifth of the runs. Draws
// are sealed from what is to find them: a diagnosis sees the record and the healthy machine,
// nothing else.

#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

struct RandomDraw {
  std::uint64_t seed = 0;         ///< of the noise, too
  std::vector<DrawnAxis> faults;  ///< in the order of the axes
  Eigen::Index from = 0;          ///< first sample that the diagnosis sees
};

/// Faults of those axes, whose ranges are at most one on either side of healthy: up or
/// down as often, evenly in the logarithm of the deviation. Records that do not begin at
/// the first sample, where the machine is at rest, begin anywhere in the first half of the
/// motion.
/// @param axes     must outlive the draw
/// @param samples  of the motion
RandomDraw DrawFaults(const AskNames& ask, const std::vector<PlanAxis>& axes,
                      Eigen::Index samples, std::uint64_t seed);

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

}  // namespace mjdiag
