#pragma once
// A diagnosis at work, tick by tick: residuals and prefilters, detection with
// thresholds, recursive estimation, and the disturbance residual. The same object runs
// inside the control callback and over a record, so both give the same bits.
//
// It keeps the present only and runs for as long as the machine does. Between ticks its
// residuals, estimate and alarms can be read; MonitorRecorder (monitor_recorder.h)
// keeps them for what looks at a whole run.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/diagnosis/residuals/fault_estimator.h"
#include "mjdiag/diagnosis/twin/twin_estimator.h"

namespace mjdiag {

class DiagnosisMonitor {
 public:
  /// @param baseline  residuals of the same motion of the healthy machine, subtracted
  ///                  sample by sample ([AB383], section A.6): n x N, or empty.
  ///                  InputError if n is not the number of residuals
  explicit DiagnosisMonitor(const DiagnosisDesign& design,
                            Eigen::MatrixXd baseline = {});

  /// From now on faults are estimated by the twin of the machine, and no more from the
  /// residuals, whose prefilters rest. InputError if it has other faults than the design.
  void Follow(std::unique_ptr<TwinEstimator> twin);
  /// Null without one.
  const TwinEstimator* twin() const { return twin_.get(); }
  /// At the end of a run: what the twin has yet to catch up with.
  void Finish() noexcept;

  /// One control tick. Does not allocate, lock, throw or do I/O.
  /// @param outputs  readings y, ny
  /// @param inputs   commands u, nu
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept;
  /// The same where not all readings were measured: the twin does without the others, the
  /// filters get what bridges them.
  /// @param measured  which were, ny
  /// @param gap       whether what bridges them is too far from any that was: nothing is
  ///                  judged then, nor before the filters have forgotten it
  void Add(std::span<const double> outputs, std::span<const double> inputs,
           std::span<const bool> measured, bool gap) noexcept;

  /// Samples before this one are filtered but not regressed: the horizon of Eq. 25.
  void RegressFrom(Eigen::Index sample) { first_regressed_ = sample; }
  Eigen::Index first_regressed() const { return first_regressed_; }

  const DiagnosisDesign& design() const { return design_; }
  /// Ticks so far; what follows is of the last of them.
  Eigen::Index samples() const { return samples_; }
  /// z as deviations from rest, nz.
  const Eigen::VectorXd& signals() const { return z_; }
  /// Residuals, less the baseline if there is one, n. The first is judged.
  const Eigen::VectorXd& residuals() const { return residuals_; }
  /// Mean of |r| over the window.
  double integral() const { return integral_; }
  /// r_dist behind its high-pass filter.
  double disturbance() const { return disturbance_; }
  /// Whether this tick was regressed, and the estimate is new.
  bool regressed() const { return regressed_; }
  /// Latest recursive estimate, deviations from healthy, nf; 0 as long as the motion
  /// has not told all faults apart.
  const Eigen::VectorXd& estimate() const { return estimate_; }
  /// Its standard deviations, nf; of a twin, now and then. NaN before that.
  const Eigen::VectorXd& estimate_sd() const { return estimate_sd_; }
  const FaultEstimator& estimator() const { return estimator_; }

  /// Whether the residual is outside its limits now. Never before the filters have
  /// settled, nor without limits.
  bool residual_alarm() const { return residual_alarm_; }
  /// Whether the integral is: the fault is no passing disturbance.
  bool lasting_alarm() const { return lasting_alarm_; }
  /// First sample at which the residual left its limits, if it did.
  std::optional<Eigen::Index> first_detection() const;
  /// First sample at which the integral did: the fault lasts.
  std::optional<Eigen::Index> first_lasting() const;

 private:
  void Start() noexcept;
  /// @param readings  NaN where they were not measured
  void Add(std::span<const double> bridged, std::span<const double> readings,
           std::span<const double> inputs) noexcept;
  /// What a unit of every fault would leave in the residuals.
  void MakeRegressors(const Eigen::VectorXd& filtered) noexcept;
  void Detect() noexcept;
  void Regress() noexcept;

  DiagnosisDesign design_;
  Eigen::MatrixXd baseline_;
  RunningBank filters_;
  RunningBank disturbance_filter_;
  RunningBank waveform_filter_;
  SectionFilter high_pass_;
  FaultEstimator estimator_;
  std::unique_ptr<TwinEstimator> twin_;
  Eigen::Index first_regressed_ = 0;
  Eigen::Index settling_away_ = 0;  // samples of a transient
  Eigen::Index settling_ = 0;       // samples before which nothing is judged
  Eigen::Index samples_ = 0;
  Eigen::Index first_detection_ = -1;
  Eigen::Index first_lasting_ = -1;
  Eigen::VectorXd z_;
  std::vector<double> readings_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd regressors_;  // nf x n
  Eigen::MatrixXd waveforms_;   // nu x disturbances
  Eigen::VectorXd drive_;       // of waveform_filter_
  Eigen::VectorXd estimate_;
  Eigen::VectorXd estimate_sd_;
  Eigen::VectorXd window_;  // ring of |r|
  double window_sum_ = 0.0;
  double integral_ = 0.0;
  double disturbance_ = 0.0;
  bool regressed_ = false;
  bool residual_alarm_ = false;
  bool lasting_alarm_ = false;
};

}  // namespace mjdiag
