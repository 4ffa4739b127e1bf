#include "mjdiag/diagnosis/diagnosis_recording.h"

#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "mjdiag/signals/bridging.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;

std::span<const double> Tick(const Eigen::MatrixXd& samples, Index k) {
  return {samples.col(k).data(), static_cast<std::size_t>(samples.rows())};
}

/// @param watcher  a monitor of that design, alone or with its recorder
template <typename Watcher>
void Feed(Watcher& watcher, const DiagnosisDesign& design, const Record& record) {
  if (std::abs(record.sample_time() / design.sample_time() - 1.0) > 1e-4) {
    throw InputError(
        "record", "sampled every " + std::to_string(record.sample_time() * 1e3) + " ms",
        "the sample time of the filters, " +
            std::to_string(design.sample_time() * 1e3) + " ms");
  }
  const Eigen::MatrixXd y = SamplesOf(record, design.outputs);
  const Eigen::MatrixXd u = SamplesOf(record, design.inputs);
  const Eigen::ArrayXX<bool> measured = MeasuredOf(record, design.outputs);
  if (measured.size() == 0) {
    for (Index k = 0; k < record.samples(); ++k) watcher.Add(Tick(y, k), Tick(u, k));
    return;
  }
  SampleMask gap = SampleMask::Constant(record.samples(), false);
  for (Index i = 0; i < measured.rows(); ++i) {
    gap = gap || InGaps(measured.row(i).transpose());
  }
  for (Index k = 0; k < record.samples(); ++k) {
    watcher.Add(Tick(y, k), Tick(u, k),
                {measured.col(k).data(), static_cast<std::size_t>(measured.rows())},
                gap[k]);
  }
}

}  // namespace

DiagnosisRecording::DiagnosisRecording(const DiagnosisDesign& design, Index capacity,
                                       Eigen::MatrixXd baseline)
    : monitor(design, std::move(baseline)), recorder(design, capacity) {}

void Run(DiagnosisMonitor& monitor, const Record& record) {
  Feed(monitor, monitor.design(), record);
  monitor.Finish();
}

void Run(DiagnosisRecording& recording, const Record& record) {
  RunPart(recording, record);
  recording.Finish();
}

void RunPart(DiagnosisRecording& recording, const Record& part) {
  Feed(recording, recording.monitor.design(), part);
}

DiagnosisRecording RecordDiagnosis(const DiagnosisDesign& design, const Record& record,
                                   const Eigen::MatrixXd& baseline, Index from) {
  DiagnosisRecording recording(design, record.samples(), baseline);
  recording.monitor.RegressFrom(from);
  Run(recording, record);
  return recording;
}

}  // namespace mjdiag
