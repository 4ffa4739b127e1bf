#include "mjdiag/studies/looked_at_runs.h"

namespace mjdiag {

bool LookedAtRuns::SeenBy(std::size_t way, double deviation, std::uint64_t seed) {
  const std::pair run{deviation, seed};
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = seen_.find(run); found != seen_.end())
      return found->second[way];
  }
  const Record record = make_(deviation, seed);
  std::vector<bool> seen;
  for (const Sees& sees : ways_) seen.push_back(sees(record));
  const std::scoped_lock lock(mutex_);
  return seen_.try_emplace(run, std::move(seen)).first->second[way];
}

}  // namespace mjdiag
