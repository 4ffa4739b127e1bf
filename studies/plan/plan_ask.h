#pragma once
// [ask]: what is asked of the runs of a plan. The answer is tables (studies/answer.h), where
// a plan that asks nothing becomes a data set. What each question
// means, answer.h says.

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace mjdiag {

struct AskBound {
  static constexpr const char* kQuestion = "information bound";
};

struct AskDisturbances {
  static constexpr const char* kQuestion = "disturbances";
};

struct AskEstimates {
  static constexpr const char* kQuestion = "estimates";
};

/// Who may look at a run (detector.h).
inline const std::vector<std::string> kJudges = {"residual", "robust residual",
                                                 "spectrum", "estimate", "twin"};

/// Of a plan with the cases "largest" and "published".
struct AskSmallestSize {
  static constexpr const char* kQuestion = "smallest size";
  std::vector<std::string> judges = kJudges;
  bool baseline = false;    ///< that of the motion is subtracted from residuals
  int limits_from = 0;      ///< healthy runs of the motion; 0: as the setup says
  int seeds = 40;           ///< of a size, at most
  double resolution = 1.1;  ///< of sizes
  bool delays = false;      ///< of the residual, at the published sizes
};

/// Of a plan with one case.
struct AskNames {
  static constexpr const char* kQuestion = "names";
  double healthy = 0.2;     ///< share of the runs
  int most = 3;             ///< faults at once
  double from_rest = 0.25;  ///< share of the runs; others begin in the motion
};

struct AskClasses {
  static constexpr const char* kQuestion = "classes";
};

struct AskCalibration {
  static constexpr const char* kQuestion = "calibration";
  int learned_from = 3;   ///< healthy runs
  int judged = 20;        ///< healthy runs
  double promised = 1.5;  ///< size of a fault over that from which on it is named
};

struct AskTolerance {
  static constexpr const char* kQuestion = "tolerance";
};

struct AskEndurance {
  static constexpr const char* kQuestion = "endurance";
  double duration = 60.0;  ///< [s]
  double every = 60.0;     ///< a row [s]
  /// Fault parameter, and by how much it grows an hour.
  std::vector<std::pair<std::string, double>> wear;
};

struct AskHidden {
  static constexpr const char* kQuestion = "hidden causes";
  bool exact = false;         ///< the model is, but for what is hidden
  std::optional<int> causes;  ///< in every case; none: as HiddenPlan PlanOf(seed)
};

using PlanAsk =
    std::variant<AskBound, AskDisturbances, AskEstimates, AskSmallestSize, AskNames,
                 AskClasses, AskCalibration, AskTolerance, AskEndurance, AskHidden>;

}  // namespace mjdiag
