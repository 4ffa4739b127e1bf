#pragma once
// Run by run what a plan asks for. Runs are numbered machine by machine, of those case by
// case, point by point, motion by motion, replication by replication.
//
// Everything that is drawn comes from generators that are seeded for the purpose:
//
//   numbers of a machine      by (seed of the plan, machine)
//   values of a point         by (seed of the plan, machine, case, point)
//   noise of the sensors      by (seed of the plan, number of the run)
//
// so that runs at the same point differ in their noise only, and no run depends on
// another. A Sobol sequence goes on from machine to machine; it is shifted by numbers
// drawn from (seed of the plan, case), modulo 1, which keeps its evenness.
//
// In a plan that asks something ([ask]) noise has the seed of the plan for the first
// replication, that plus one for the second and so on, so that what is compared has the same
// noise; of points that are drawn each has seeds of its own.

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag {

/// What one axis is in a run.
struct DrawnAxis {
  const PlanAxis* axis = nullptr;
  double value = 0.0;
  double time = 0.0;   ///< from which on, if the axis has such
  bool varies = true;  ///< it was chosen; else it is healthy
  /// Something is wrong by it: a fault, disturbance or effect off its healthy value.
  bool present() const;
};

struct PlannedRun {
  std::int64_t index = 0;
  int machine = 0;
  Split split = Split::kTrain;
  int in_case = 0;         ///< which one
  std::int64_t point = 0;  ///< of all points of the plan, counted on
  int motion = 0;          ///< which one
  int replication = 0;
  std::uint64_t seed = 0;       ///< of the noise
  std::vector<DrawnAxis> axes;  ///< of the case
  NumberFactors numbers;        ///< of the machine over those of the plant

  /// Names of what is present, in the order of the plan, joined by " + "; "healthy".
  std::string Label() const;
};

/// An axis of a data set: cases may share one.
struct PlanColumn {
  std::string name;
  std::string unit;
  AxisKind kind = AxisKind::kFault;
  double healthy = 1.0;
};

class RunPlanner {
 public:
  /// The plan must outlive it.
  explicit RunPlanner(const StudyPlan& plan);

  std::int64_t runs() const { return plan_.Runs(); }
  /// @param index  from 0 to runs() - 1
  PlannedRun Run(std::int64_t index) const;

  Split SplitOf(int machine) const {
    return splits_[static_cast<std::size_t>(machine)];
  }
  NumberFactors NumbersOf(int machine) const;

  /// Every axis once, in the order in which the plan has them.
  const std::vector<PlanColumn>& columns() const { return columns_; }
  /// The values of a run, of every column; healthy where its case has no such axis, NaN
  /// of a key of the setup.
  std::vector<double> ValuesOf(const PlannedRun& run) const;
  /// Since when, of every column [s]; 0: from the start.
  std::vector<double> TimesOf(const PlannedRun& run) const;

 private:
  /// The coordinates of a point, each from 0 to below 1.
  std::vector<double> Coordinates(std::size_t in_case, int machine, int point) const;

  const StudyPlan& plan_;
  std::vector<Split> splits_;
  std::vector<PlanColumn> columns_;
};

/// One of the values that an axis can have: u from 0 to below 1.
double ValueAt(const PlanAxis& axis, double u);
/// Those of a grid.
std::vector<double> GridValues(const PlanAxis& axis);

}  // namespace mjdiag
