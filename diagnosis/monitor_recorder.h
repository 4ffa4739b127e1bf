#pragma once
// What a monitor said tick by tick, for all that looks at a run as a whole: limits,
// spectra, verdicts, pages. The monitor itself knows the present only and runs for as
// long as it likes; a recorder has room for one run of known length.

#include <Eigen/Core>

#include "mjdiag/diagnosis/monitor.h"

namespace mjdiag {

/// What is kept of a run.
struct MonitorLog {
  Eigen::VectorXd residual;       ///< r, less the baseline if there is one
  Eigen::VectorXd integral;       ///< mean of |r| over the window
  Eigen::VectorXd disturbance;    ///< r_dist behind its high-pass filter
  Eigen::MatrixXd signals;        ///< z as deviations from rest, nz x samples
  Eigen::VectorXd estimate_time;  ///< since the first tick kept [s]
  Eigen::MatrixXd estimates;      ///< nf x regressed samples, deviations from healthy
  Eigen::MatrixXd estimate_sd;    ///< of those of a twin; empty without one
};

class MonitorRecorder {
 public:
  /// @param design    of the monitors that it will see
  /// @param capacity  ticks that it has room for; later ones are not kept
  MonitorRecorder(const DiagnosisDesign& design, Eigen::Index capacity);

  /// What the monitor knows now: once after every tick of the monitor. Does not
  /// allocate, lock, throw or do I/O.
  void Add(const DiagnosisMonitor& monitor) noexcept;

  /// At the end of a run: the last estimate, as it is when the monitor has finished.
  void AddFinal(const DiagnosisMonitor& monitor) noexcept;

  /// Ticks kept.
  Eigen::Index samples() const { return samples_; }
  MonitorLog Log() const;
  /// Every residual of the run, n x samples: what becomes a baseline.
  Eigen::MatrixXd Residuals() const { return residuals_.leftCols(samples_); }

 private:
  double sample_time_;
  int decimation_;
  Eigen::Index seen_ = 0;
  Eigen::Index samples_ = 0;
  Eigen::Index estimates_made_ = 0;
  Eigen::Index first_estimate_ = 0;
  Eigen::MatrixXd residuals_;    // n x capacity
  Eigen::VectorXd integral_;     // capacity
  Eigen::VectorXd disturbance_;  // capacity
  Eigen::MatrixXd signals_;      // nz x capacity
  Eigen::MatrixXd estimates_;    // nf x capacity / decimation
  Eigen::MatrixXd estimate_sd_;  // the same
  bool by_twin_ = false;
};

}  // namespace mjdiag
