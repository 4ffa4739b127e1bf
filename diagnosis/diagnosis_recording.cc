#include "mjdiag/diagnosis/diagnosis_recording.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;

std::vector<const Channel*> Find(const std::vector<std::string>& names,
                                 const Record& record) {
  std::vector<const Channel*> channels;
  for (const std::string& name : names) channels.push_back(&record.At(name));
  return channels;
}

void Read(const std::vector<const Channel*>& channels, Index sample,
          std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = channels[i]->samples[sample];
  }
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
  const std::vector<const Channel*> outputs = Find(design.outputs, record);
  const std::vector<const Channel*> inputs = Find(design.inputs, record);
  std::vector<double> y(outputs.size());
  std::vector<double> u(inputs.size());
  for (Index k = 0; k < record.samples(); ++k) {
    Read(outputs, k, y);
    Read(inputs, k, u);
    watcher.Add(y, u);
  }
}

}  // namespace

DiagnosisRecording::DiagnosisRecording(const DiagnosisDesign& design, Index capacity,
                                       Eigen::MatrixXd baseline)
    : monitor(design, std::move(baseline)), recorder(design, capacity) {}

void Run(DiagnosisMonitor& monitor, const Record& record) {
  Feed(monitor, monitor.design(), record);
}

void Run(DiagnosisRecording& recording, const Record& record) {
  Feed(recording, recording.monitor.design(), record);
}

DiagnosisRecording RecordDiagnosis(const DiagnosisDesign& design, const Record& record,
                                   const Eigen::MatrixXd& baseline, Index from) {
  DiagnosisRecording recording(design, record.samples(), baseline);
  recording.monitor.RegressFrom(from);
  Run(recording, record);
  return recording;
}

}  // namespace mjdiag
