#pragma once
// A finished diagnosis: filters, thresholds and settings, all that a monitor needs to
// run inside the control callback or over a record. `mjdiag design` writes it to
// filters.json.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_options.h"
#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"
#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/diagnosis/statistics/thresholds.h"
#include "mjdiag/signals/second_order_sections.h"

namespace mjdiag {

/// gamma * amplitude * sum_f sin(2 pi f t) on the commands, [AB383], Eq. 7.
struct Multisine {
  std::string name;
  std::vector<double> frequencies;  ///< [Hz]
  Eigen::VectorXd amplitude;        ///< nu, of each command
};

/// R_dist with its high-pass filter (Eq. 33 and 34), one residual, and its prefilters,
/// with which the part that is due to known faults is taken out.
struct DisturbanceFilter {
  FilterBank filter;      ///< one output
  FilterBank prefilters;  ///< one output a fault parameter
  SecondOrderSections high_pass;
};

/// Probability with which the estimate of a healthy run lies outside its limits.
inline constexpr double kOutsideLimits = 1e-3;

/// Limits found on nominal runs.
struct DiagnosisLimits {
  ThresholdDesign residual;
  double integral = 0.0;  ///< of the windowed mean of |r|
  /// Of every estimate's deviation from healthy: an estimate is judged, and reported,
  /// relative to their middle, with their width in its standard deviation. Empty: the
  /// interval of the estimate alone decides.
  std::vector<Interval> estimates;
  DisturbanceThresholds disturbance;
  bool known = false;
};

struct DiagnosisDesign {
  std::string setup;
  bool linear = false;  ///< the machine is taken as linear, without dry friction
  std::vector<std::string> outputs;  ///< channels of y
  std::vector<std::string> inputs;   ///< channels of u
  Eigen::VectorXd offset;            ///< readings at rest, ny
  Eigen::VectorXd sensor_noise;      ///< ny
  ResidualBank bank;
  std::vector<Multisine> disturbances;
  DisturbanceFilter disturbance;
  int decimation = 1;  ///< samples between regressed ones
  DiagnosisOptions options;
  DiagnosisLimits limits;

  double sample_time() const { return bank.filters.sample_time; }
  /// Fault parameters, then disturbances.
  std::vector<std::string> FaultNames() const;
  Eigen::Index faults() const {
    return static_cast<Eigen::Index>(bank.faults.size() + disturbances.size());
  }
  /// Its value on a healthy machine: 1, and 0 for disturbances.
  double Healthy(Eigen::Index fault) const {
    return fault < static_cast<Eigen::Index>(bank.faults.size()) ? 1.0 : 0.0;
  }
};

/// gamma's waveform at sample k for a unit of every disturbance, nu x disturbances.
void Waveforms(const std::vector<Multisine>& disturbances, double time,
               Eigen::Ref<Eigen::MatrixXd> waveforms) noexcept;

}  // namespace mjdiag
