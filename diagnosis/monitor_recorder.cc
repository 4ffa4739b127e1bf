#include "mjdiag/diagnosis/monitor_recorder.h"

#include <algorithm>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

MonitorRecorder::MonitorRecorder(const DiagnosisDesign& design, Index capacity)
    : sample_time_(design.sample_time()),
      decimation_(design.decimation),
      residuals_(design.bank.residuals, capacity),
      integral_(capacity),
      disturbance_(capacity),
      signals_(design.bank.filters.inputs(), capacity),
      estimates_(design.faults(), capacity / design.decimation + 1),
      estimate_sd_(estimates_.rows(), estimates_.cols()) {}

void MonitorRecorder::Add(const DiagnosisMonitor& monitor) noexcept {
  if (samples_ < residuals_.cols()) {
    residuals_.col(samples_) = monitor.residuals();
    integral_[samples_] = monitor.integral();
    disturbance_[samples_] = monitor.disturbance();
    signals_.col(samples_) = monitor.signals();
    ++samples_;
  }
  if (monitor.regressed() && estimates_made_ < estimates_.cols()) {
    if (estimates_made_ == 0) first_estimate_ = seen_;
    estimates_.col(estimates_made_) = monitor.estimate();
    estimate_sd_.col(estimates_made_) = monitor.estimate_sd();
    by_twin_ = monitor.twin() != nullptr;
    ++estimates_made_;
  }
  ++seen_;
}

void MonitorRecorder::AddFinal(const DiagnosisMonitor& monitor) noexcept {
  if (estimates_made_ == 0) return;
  estimates_.col(estimates_made_ - 1) = monitor.estimate();
  estimate_sd_.col(estimates_made_ - 1) = monitor.estimate_sd();
}

MonitorLog MonitorRecorder::Log() const {
  const VectorXd index =
      VectorXd::LinSpaced(estimates_made_, 0.0,
                          static_cast<double>(std::max<Index>(0, estimates_made_ - 1)));
  return {residuals_.row(0).head(samples_),
          integral_.head(samples_),
          disturbance_.head(samples_),
          signals_.leftCols(samples_),
          sample_time_ *
              (index.array() * decimation_ + static_cast<double>(first_estimate_)),
          estimates_.leftCols(estimates_made_),
          estimate_sd_.leftCols(by_twin_ ? estimates_made_ : 0)};
}

}  // namespace mjdiag
