#include "mjdiag/discovery/answer/split_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;

namespace {

void RequireSharedPlant(const std::vector<MeasuredRecord>& records) {
  for (const MeasuredRecord& one : records) {
    if (!one.own_plant) continue;
    throw InputError(one.name, "has a plant of its own",
                     "records of one load at a time, each with the setup of that load");
  }
}

}  // namespace

SplitRun Split(const Measurements& measurements, double train_share) {
  RequireSharedPlant(measurements.fit);
  RequireSharedPlant(measurements.unseen);
  MeasuredRun run = RunOf(measurements.fit);
  if (!measurements.unseen.empty()) {
    return {std::move(run), RunOf(measurements.unseen), 0, 1.0};
  }
  const Index samples = run.samples();
  const auto wished =
      static_cast<Index>(std::lround(train_share * static_cast<double>(samples)));
  const Index seen = std::clamp<Index>(wished, 1, samples - 1);
  return {Part(run, 0, seen), run, seen,
          static_cast<double>(seen) / static_cast<double>(samples)};
}

}  // namespace mjdiag
