#include "mjdiag/studies/dataset/dataset_layout.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// The channels that a run has.
Record FewTicks(const LoadedPlan& loaded) {
  constexpr int kTicks = 4;
  LoadedPlan brief = loaded;
  brief.plan.duration = kTicks * loaded.machine.rates().tick();
  const RunPlanner planner(brief.plan);
  return RunMaker(brief).Simulate(planner.Run(0));
}

void RequireLongEnough(const PlanKeep& keep, const std::vector<Excitation>& motions) {
  if (keep.features.empty()) return;
  for (const Excitation& motion : motions) {
    if (motion.samples() >= keep.segment) continue;
    throw InputError("keep.segment",
                     std::to_string(keep.segment) + " samples are more than a run has",
                     "at most " + std::to_string(motion.samples()));
  }
}

}  // namespace

FeatureOptions FeatureOptionsOf(const PlanKeep& keep) {
  FeatureOptions options;
  options.segment = keep.segment;
  options.bands = std::min(options.bands, static_cast<int>(std::log2(keep.segment)));
  return options;
}

DatasetLayout LayoutOf(const LoadedPlan& loaded, const RunMaker& maker) {
  const PlanKeep& keep = loaded.plan.keep;
  if (keep.Series() && !PacksSeries()) {
    throw InputError("keep",
                     "records and residuals ask for HDF5, which this build lacks",
                     "verdicts, estimates and features, or a build with libhdf5-dev");
  }
  RequireLongEnough(keep, maker.motions());
  DatasetLayout layout;
  layout.sample_time = loaded.machine.rates().tick() * keep.every;
  const Eigen::Index samples = (maker.longest() + keep.every - 1) / keep.every;
  const Record record = FewTicks(loaded);
  const auto add = [&](const Channel& channel) {
    layout.series.push_back(
        {"records", channel.name, channel.unit, samples, keep.single_precision});
  };
  for (const std::string& name : keep.channels) add(record.At(name));
  for (const std::string& name : keep.joints) add(record.At("joint." + name));
  if (keep.residual) {
    layout.series.push_back({"residual", "r", "1", samples, keep.single_precision});
  }
  if (keep.Diagnoses()) layout.faults = MakeFaultFamily(loaded.machine).Names();
  if (!keep.features.empty()) {
    layout.features = FeatureNames(record, keep.features, FeatureOptionsOf(keep));
    layout.feature_channels = keep.features;
  }
  return layout;
}

}  // namespace mjdiag
