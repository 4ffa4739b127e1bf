#pragma once
// Runs of one fault, each of which is made once and looked at in several ways: where runs
// take longer than looking at them, ways that are asked about the same sizes share them.

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "mjdiag/studies/machine_study.h"

namespace mjdiag {

class LookedAtRuns {
 public:
  using MakeRun = std::function<Record(double deviation, std::uint64_t seed)>;
  using Sees = std::function<bool(const Record&)>;

  LookedAtRuns(MakeRun make, std::vector<Sees> ways)
      : make_(std::move(make)), ways_(std::move(ways)) {}

  /// Whether that way sees the fault of that size in the run of that seed. From any thread.
  bool SeenBy(std::size_t way, double deviation, std::uint64_t seed);

 private:
  const MakeRun make_;
  const std::vector<Sees> ways_;
  std::mutex mutex_;
  std::map<std::pair<double, std::uint64_t>, std::vector<bool>> seen_;
};

}  // namespace mjdiag
