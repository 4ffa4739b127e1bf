#include "mjdiag/discovery/answer/split_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/replay/coarser_run.h"

namespace mjdiag {

using Eigen::Index;

SampleMask SplitRun::New() const {
  SampleMask all = SampleMask::Constant(unseen.samples(), true);
  for (std::size_t r = 0; r < seen_of.size(); ++r) {
    all.segment(unseen.records[r].sample, seen_of[r]).setConstant(false);
  }
  return all;
}

SplitRun Coarser(const SplitRun& run, int ticks) {
  SplitRun coarse{Coarser(run.seen, ticks), Coarser(run.unseen, ticks), run.seen_of,
                  run.share};
  for (Index& seen : coarse.seen_of) seen /= ticks;
  return coarse;
}

SplitRun Split(const Measurements& measurements, double train_share) {
  MeasuredRun run = RunOf(measurements.fit);
  if (!measurements.unseen.empty()) {
    MeasuredRun unseen = RunOf(measurements.unseen);
    const std::vector<Index> none(unseen.records.size(), 0);
    return {std::move(run), std::move(unseen), none, 1.0};
  }
  std::vector<Index> seen_of;
  std::vector<MeasuredRun> parts;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    const Index samples = run.SamplesOf(r);
    const auto wished =
        static_cast<Index>(std::lround(train_share * static_cast<double>(samples)));
    seen_of.push_back(std::clamp<Index>(wished, 1, samples - 1));
    parts.push_back(Part(run, r, seen_of.back()));
  }
  MeasuredRun seen = Joined(parts);
  const double share =
      static_cast<double>(seen.samples()) / static_cast<double>(run.samples());
  return {std::move(seen), std::move(run), std::move(seen_of), share};
}

}  // namespace mjdiag
