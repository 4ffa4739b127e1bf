#include "mjdiag/discovery/regression/whitenings.h"

#include <optional>
#include <utility>

#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

std::vector<FilterNoise> NoisesFrom(const FilterNoise& found) {
  std::vector<FilterNoise> noises;
  for (const double part : {1.0, 0.2, 0.02, 1e-6}) {
    noises.push_back(found);
    noises.back().size *= part;
    noises.back().white *= part;
  }
  return noises;
}

Whitenings WhiteningsOf(const FilterPath& path) {
  const Eigen::MatrixXd inflation = OverdispersionAlong(path);
  Whitenings all{NoisesFrom(path.noise), {}};
  std::vector<std::optional<KeptGains>> gains(all.noises.size());
  ParallelFor(static_cast<int>(gains.size()), [&](int number) {
    const auto r = static_cast<std::size_t>(number);
    gains[r] = KeepGains(path, all.noises[r], inflation);
  });
  for (std::optional<KeptGains>& one : gains) {
    all.behind.emplace_back(path, std::move(*one));
  }
  return all;
}

}  // namespace mjdiag
