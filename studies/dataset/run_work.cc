#include "mjdiag/studies/dataset/run_work.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {

RunWork::RunWork(const LoadedPlan& loaded)
    : loaded_(loaded),
      planner_(loaded.plan),
      maker_(loaded),
      layout_(LayoutOf(loaded, maker_)) {
  if (!loaded.plan.ask) return;
  throw InputError("plan '" + loaded.plan.name + "'", "asks something",
                   "a plan that keeps something of its runs");
}

void RunWork::Prepare(const std::function<void(double fraction)>& progress) {
  if (!loaded_.plan.keep.Diagnoses() || prepared_) return;
  DiagnosisSource source;
  source.nominal.linear = loaded_.plan.linear;
  source.nominal.progress = progress;
  prepared_ =
      std::make_unique<PreparedDiagnosis>(PrepareDiagnosis(loaded_.machine, source));
}

void RunWork::KeepVerdict(const Diagnosis& diagnosis, RunResult& result) const {
  const DiagnosisResult& said = diagnosis.result;
  result.detected = said.detected;
  result.first_detection = said.first_detection.value_or(kNoValue);
  result.lasting = said.lasting.value_or(kNoValue);
  result.disturbed = said.disturbance.disturbed;
  result.nis = said.nis;
  result.residual_low = said.residual.min;
  result.residual_high = said.residual.max;
  result.faults.resize(layout_.faults.size());
  for (const FaultVerdict& fault : said.faults) {
    const auto at = std::ranges::find(layout_.faults, fault.name);
    if (at == layout_.faults.end()) continue;
    result.faults[static_cast<std::size_t>(at - layout_.faults.begin())] = {
        fault.value, fault.sd, fault.detected};
  }
}

RunResult RunWork::Do(std::int64_t index) const {
  const PlanKeep& keep = loaded_.plan.keep;
  RunResult result;
  const ReadyRun ready = maker_.Make(planner_.Run(index));
  try {
    const Record record = maker_.Simulate(ready);
    result.samples = record.samples();
    std::optional<Diagnosis> diagnosis;
    if (prepared_) {
      diagnosis = Diagnose(loaded_.machine, *prepared_, record);
      KeepVerdict(*diagnosis, result);
    }
    for (const Series& series : layout_.series) {
      result.series.push_back(Pack(series,
                                   series.group == "residual"
                                       ? diagnosis->log.residual
                                       : record.At(series.name).samples,
                                   keep.every));
    }
    if (!keep.features.empty()) {
      const Eigen::VectorXd features =
          Features(record, keep.features, FeatureOptionsOf(keep));
      result.features.assign(features.begin(), features.end());
    }
  } catch (const NumericalError& error) {
    result = {};
    result.failure = error.what();
  }
  return result;
}

}  // namespace mjdiag
