#pragma once
// What a diagnosis found in one of the runs, as it stood at every moment: plain numbers
// for a clip to draw in step with the motion.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/signals/record.h"

namespace mjdiag {

/// The estimate of one fault over DiagnosisOverlay::estimate_time. NaN as long as the
/// motion has not determined it.
struct EstimateHistory {
  std::string name;            ///< of the fault parameter
  double healthy = 1.0;        ///< its value on a healthy machine
  Eigen::VectorXd value;       ///< estimated
  Eigen::VectorXd half_width;  ///< of its 95 % interval, in its unit
};

struct DiagnosisOverlay {
  std::size_t run = 0;  ///< index of the run that is diagnosed
  Record residual;      ///< its one channel is the residual, a pure number
  double limit_low = 0.0;
  double limit_high = 0.0;
  /// When the residual first left its limits [s], if it did.
  std::optional<double> detection;
  Eigen::VectorXd estimate_time;  ///< ascending [s]
  std::vector<EstimateHistory> estimates;
};

/// InputError names what does not fit together: a run that is not there, no residual,
/// limits the wrong way round or histories of another length than their times.
void CheckOverlay(const DiagnosisOverlay& overlay, std::size_t runs);

/// Index of the latest estimate at `time` [s]; nothing before the first.
std::optional<Eigen::Index> EstimateAt(const DiagnosisOverlay& overlay, double time);

/// "0.0185 s", to the residual's sample.
std::string DetectionText(const DiagnosisOverlay& overlay);

}  // namespace mjdiag
