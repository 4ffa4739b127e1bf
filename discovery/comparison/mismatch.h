#pragma once
// What a simulation gets wrong: one measured signal y against one simulated signal yhat
// of the same length n and sample time.
//
//   mismatch        e_k = y_k - yhat_k
//   rms             sqrt(mean e^2)
//   mae             mean |e|
//   fit             100 (1 - ||e|| / ||y - mean y||) [%], 100 where nothing is wrong, 0
//                   where the mean of y would do as well, negative beyond
//   relative error  100 ||y - yhat|| / ||y|| [%], as Janot, Gautier and Brunot compute
//                   it for EMPS ("Data Set and Reference Models of EMPS", 2019)
//
// The first skip_samples, in which the unknown initial state still shows, and samples at
// which y was not measured are left out of every figure.
//
// Is there anything but noise? Under the null hypothesis e is the noise whose rms the
// floor estimates, and F = mean(e^2) / floor^2 is F distributed with the floor's two
// degrees of freedom. The mismatch exceeds its floor if F is larger than the upper
// quantile of that distribution at `level`: a one-sided test, each channel by itself.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/signals/record.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

/// The rms that a mismatch would have if noise were all there is, and how well it is
/// known. A rms of 0 says that the channel is free of noise: whatever differs exceeds.
struct NoiseFloor {
  double rms = 0.0;  ///< unit of the channel
  /// Independent values that the mean square of such a mismatch holds; below the number
  /// of samples if the noise is coloured.
  double mismatch_freedom = 0.0;
  /// The same of the estimate `rms` itself.
  double floor_freedom = 0.0;
  Spectrum spectrum{};  ///< one-sided power spectral density [unit^2/Hz]; may be empty
  /// The rms of single draws of the noise, from which `rms` is; may be empty.
  std::vector<double> draws{};
};

struct MismatchOptions {
  Eigen::Index skip_samples = 0;  ///< left out at the start
  double window = 0.0;  ///< of the worst window [s]; 0: a fiftieth of the record
  double level = 0.01;  ///< chance to call plain noise a mismatch, per channel
};

/// The window in which the mismatch has the largest rms.
struct WorstWindow {
  double start = 0.0;     ///< [s], on the time axis of the record
  double duration = 0.0;  ///< [s]
  double rms = 0.0;       ///< unit of the channel
};

struct ChannelMismatch {
  std::string name;
  std::string unit;  ///< SI, of rms, mae, peak, worst.rms and noise_floor.rms
  double rms = 0.0;
  double mae = 0.0;   ///< mean |e|
  double peak = 0.0;  ///< max |e|
  double fit_percent = 0.0;
  double relative_error_percent = 0.0;
  WorstWindow worst;
  Spectrum spectrum;  ///< one-sided power spectral density of e [unit^2/Hz]
  NoiseFloor noise_floor;
  double p_value = 1.0;  ///< chance that noise alone reaches this rms
  bool exceeds_noise = false;
};

/// sqrt(mean x^2) of at least one sample.
double Rms(const Eigen::VectorXd& x);

/// Welch's estimate with segments of a power of two, short enough for an average of at
/// least 15 where the signal allows.
Spectrum PowerSpectrum(const Eigen::VectorXd& x, double sample_time);

/// 100 ||measured - simulated|| / ||measured|| after the first `skip` samples [%].
/// 0 if both are zero, infinite if only `measured` is.
double RelativeErrorPercent(const Eigen::VectorXd& measured,
                            const Eigen::VectorXd& simulated, Eigen::Index skip);

/// 100 (1 - ||measured - simulated|| / ||measured - mean of measured||) after the first
/// `skip` samples [%]. 100 if both norms are zero, minus infinity if only the second is.
double FitPercent(const Eigen::VectorXd& measured, const Eigen::VectorXd& simulated,
                  Eigen::Index skip);

/// The same of the samples that count, and e there: after the first `skip`, where
/// `measured` was measured.
double RelativeErrorPercent(const Channel& measured, const Channel& simulated,
                            Eigen::Index skip);
double FitPercent(const Channel& measured, const Channel& simulated, Eigen::Index skip);
Eigen::VectorXd MismatchOf(const Channel& measured, const Channel& simulated,
                           Eigen::Index skip);

/// The window of `length` samples with the largest rms of `mismatch`, which is sampled
/// at start_time + k * sample_time.
WorstWindow FindWorstWindow(const Eigen::VectorXd& mismatch, double sample_time,
                            double start_time, Eigen::Index length);

/// Chance that a mean square of `rms`^2 or more comes from noise of that floor alone
/// (upper tail of the F distribution). With three draws or more it is at least the
/// chance that one more draw reaches it, by Student's t on the logarithms of their mean
/// squares: noise that makes dry friction slip now and then is neither stationary nor
/// Gaussian, and only its draws tell how much its power varies.
double NoiseProbability(double rms, const NoiseFloor& floor);

/// All figures of the channel `name`, which both records must have. InputError if the
/// records differ in length or sample time, or if skip_samples leaves fewer than two.
ChannelMismatch MeasureMismatch(const Record& measured, const Record& simulated,
                                const std::string& name, const NoiseFloor& floor,
                                const MismatchOptions& options);

}  // namespace mjdiag
