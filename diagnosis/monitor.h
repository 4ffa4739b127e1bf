#pragma once
// A diagnosis at work, sample by sample: residuals and prefilters, detection with
// thresholds, recursive estimation, and the disturbance residual. The same object runs
// inside the control callback and over a record, so both give the same bits.

#include <Eigen/Core>
#include <optional>
#include <span>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/diagnosis/fault_estimator.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// What a monitor keeps of a run.
struct MonitorLog {
  Eigen::VectorXd residual;       ///< r, less the baseline if there is one
  Eigen::VectorXd integral;       ///< mean of |r| over the window
  Eigen::VectorXd disturbance;    ///< r_dist behind its high-pass filter
  Eigen::MatrixXd signals;        ///< z as deviations from rest, nz x samples
  Eigen::VectorXd estimate_time;  ///< [s]
  Eigen::MatrixXd estimates;      ///< nf x regressed samples, deviations from healthy
};

class DiagnosisMonitor {
 public:
  /// @param capacity  samples that the log can hold; later ones are not kept
  /// @param baseline  residuals of the same motion of the healthy machine, subtracted
  ///                  sample by sample (section A.6 of the seed): n x N, or empty
  DiagnosisMonitor(const DiagnosisDesign& design, Eigen::Index capacity,
                   Eigen::MatrixXd baseline = {});

  /// One control tick. Does not allocate, lock, throw or do I/O.
  /// @param outputs  readings y, ny
  /// @param inputs   commands u, nu
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept;

  /// Samples before this one are filtered but not regressed: the horizon of Eq. 25.
  void RegressFrom(Eigen::Index sample) { first_regressed_ = sample; }
  Eigen::Index first_regressed() const { return first_regressed_; }

  Eigen::Index samples() const { return samples_; }
  /// Residuals of the last sample, n.
  const Eigen::VectorXd& residuals() const { return residuals_; }
  const FaultEstimator& estimator() const { return estimator_; }
  /// Latest recursive estimate, deviations from healthy, nf.
  const Eigen::VectorXd& estimate() const { return estimate_; }
  /// First sample at which the residual left its limits, if it did.
  std::optional<Eigen::Index> first_detection() const;
  /// First sample at which the integral did: the fault lasts.
  std::optional<Eigen::Index> first_lasting() const;
  MonitorLog Log() const;
  /// Every residual row of the run, n x samples: what becomes a baseline.
  Eigen::MatrixXd ResidualRows() const { return rows_.leftCols(logged_); }

 private:
  void Start() noexcept;
  void Detect() noexcept;
  void Regress() noexcept;

  DiagnosisDesign design_;
  Eigen::MatrixXd baseline_;
  RunningBank filters_;
  RunningBank disturbance_filter_;
  RunningBank waveform_filter_;
  SectionFilter high_pass_;
  FaultEstimator estimator_;
  Eigen::Index first_regressed_ = 0;
  Eigen::Index settling_away_ = 0;  // samples of a transient
  Eigen::Index settling_ = 0;       // samples before which nothing is judged
  Eigen::Index samples_ = 0;
  Eigen::Index logged_ = 0;
  Eigen::Index estimates_made_ = 0;
  Eigen::Index first_estimate_ = 0;
  Eigen::Index first_detection_ = -1;
  Eigen::Index first_lasting_ = -1;
  Eigen::VectorXd z_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd regressors_;  // nf x n
  Eigen::MatrixXd waveforms_;   // nu x disturbances
  Eigen::VectorXd drive_;       // of waveform_filter_
  Eigen::VectorXd estimate_;
  Eigen::VectorXd window_;  // ring of |r|
  double window_sum_ = 0.0;
  Eigen::MatrixXd rows_;         // n x capacity
  Eigen::VectorXd integral_;     // capacity
  Eigen::VectorXd disturbance_;  // capacity
  Eigen::MatrixXd signals_;      // nz x capacity
  Eigen::MatrixXd estimates_;    // nf x capacity / stride
};

/// Runs a monitor over a record. InputError if a channel is missing or the record is
/// sampled at another rate than the filters.
void Run(DiagnosisMonitor& monitor, const DiagnosisDesign& design,
         const Record& record);

}  // namespace mjdiag
