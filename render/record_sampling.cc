#include "mjdiag/render/record_sampling.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {

double SampleAt(const Record& record, const Eigen::VectorXd& samples, double time) {
  const auto last = static_cast<double>(samples.size() - 1);
  const double position =
      std::clamp((time - record.start_time()) / record.sample_time(), 0.0, last);
  const auto below = static_cast<Eigen::Index>(position);
  const Eigen::Index above = std::min(below + 1, samples.size() - 1);
  const double fraction = position - static_cast<double>(below);
  return samples[below] + fraction * (samples[above] - samples[below]);
}

SampleRange SamplesWithin(const Record& record, TimeRange range) {
  const auto index = [&](double time) {
    return (time - record.start_time()) / record.sample_time();
  };
  // The slack keeps a sample that lies on the boundary but for rounding.
  const auto end = static_cast<double>(record.samples() - 1);
  const double first = std::clamp(std::ceil(index(range.begin) - 1e-6), 0.0, end);
  const double last = std::clamp(std::floor(index(range.end) + 1e-6), first, end);
  return {static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last)};
}

}  // namespace mjdiag
