#pragma once
// What is kept of a run of a plan.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace mjdiag {

inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// What the diagnosis says of a fault.
struct KeptEstimate {
  double value =
      kNoValue;  ///< of the fault parameter, 1 healthy; disturbances 0 healthy
  double sd = kNoValue;
  bool named = false;
};

/// A run that diverged has `failure` and nothing else.
struct RunResult {
  std::string failure;
  std::int64_t samples = 0;  ///< of its record at the control rate
  bool detected = false;
  double first_detection = kNoValue;  ///< of the residual [s]
  double lasting = kNoValue;          ///< when its windowed mean left its limit [s]
  bool disturbed = false;             ///< tones or raised noise
  double nis = kNoValue;              ///< of the twin
  double residual_low = kNoValue;     ///< extremes of r
  double residual_high = kNoValue;
  std::vector<KeptEstimate> faults;
  std::vector<double> features;
  /// Packed samples of every series (series.h); empty of a run that diverged.
  std::vector<std::string> series;

  bool diverged() const { return !failure.empty(); }
};

/// All but the series, as bytes, and back. InputError on bytes that are none.
std::string Packed(const RunResult& result);
RunResult Unpacked(const std::string& bytes);

}  // namespace mjdiag
