#pragma once
// [ask]: what is asked of the runs of a plan. The answer is tables (studies/answer.h), where
// a plan that asks nothing becomes a data set. What each question means, and how it is
// answered, the header of its study says.

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace mjdiag {

/// bound_study.h
struct AskBound {
  static constexpr const char* kQuestion = "information bound";
};

/// disturbance_study.h
struct AskDisturbances {
  static constexpr const char* kQuestion = "disturbances";
};

/// estimation_study.h
struct AskEstimates {
  static constexpr const char* kQuestion = "estimates";
};

/// Who looks at a run (detector.h).
enum class Judge { kResidual, kRobustResidual, kSpectrum, kEstimate, kTwin };

/// detection_study.h, of a plan with the cases "largest" and "published".
struct AskSmallestSize {
  static constexpr const char* kQuestion = "smallest size";
  std::vector<Judge> judges;
  bool baseline = false;    ///< that of the motion is subtracted from residuals
  int limits_from = 0;      ///< healthy runs of the motion; 0: as the setup says
  int seeds = 40;           ///< of a size, at most
  double resolution = 1.1;  ///< of sizes
  bool delays = false;      ///< of the residual, at the published sizes
};

/// random_fault_study.h, of a plan with one case.
struct AskNames {
  static constexpr const char* kQuestion = "names";
  double healthy = 0.2;     ///< share of the runs
  int most = 3;             ///< faults at once
  double from_rest = 0.25;  ///< share of the runs; others begin in the motion
};

/// classification_study.h
struct AskClasses {
  static constexpr const char* kQuestion = "classes";
};

/// calibration_study.h
struct AskCalibration {
  static constexpr const char* kQuestion = "calibration";
  int learned_from = 3;   ///< healthy runs
  int judged = 20;        ///< healthy runs
  double promised = 1.5;  ///< size of a fault over that from which on it is named
};

/// tolerance_study.h
struct AskTolerance {
  static constexpr const char* kQuestion = "tolerance";
};

/// endurance_study.h
struct AskEndurance {
  static constexpr const char* kQuestion = "endurance";
  double duration = 60.0;  ///< [s]
  double every = 60.0;     ///< a row [s]
  /// Fault parameter, and by how much it grows an hour.
  std::vector<std::pair<std::string, double>> wear;
};

using PlanAsk =
    std::variant<AskBound, AskDisturbances, AskEstimates, AskSmallestSize, AskNames,
                 AskClasses, AskCalibration, AskTolerance, AskEndurance>;

}  // namespace mjdiag
