#include "mjdiag/diagnosis/twin/running_tones.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

RunningTones::RunningTones(std::vector<UnknownTone> tones, double sample_time)
    : tones_(std::move(tones)) {
  const auto count = static_cast<Index>(tones_.size());
  sine_ = cosine_ = turn_ = turn_sine_ = turn_cosine_ = VectorXd::Zero(count);
  for (Index i = 0; i < count; ++i) {
    turn_[i] = tones_[static_cast<std::size_t>(i)].frequency * sample_time;
    const double angle = 2.0 * std::numbers::pi * turn_[i];
    turn_sine_[i] = std::sin(angle);
    turn_cosine_[i] = std::cos(angle);
  }
  Start(0);
}

void RunningTones::Start(Index tick) noexcept {
  for (Index i = 0; i < count(); ++i) {
    const double turns = turn_[i] * static_cast<double>(tick);
    const double angle = 2.0 * std::numbers::pi * (turns - std::floor(turns));
    sine_[i] = std::sin(angle);
    cosine_[i] = std::cos(angle);
  }
}

void RunningTones::AddTo(VectorXd& inputs,
                         const Eigen::Ref<const VectorXd>& parts) const noexcept {
  for (Index i = 0; i < count(); ++i) {
    inputs += (parts[2 * i] * sine_[i] + parts[2 * i + 1] * cosine_[i]) * amplitude(i);
  }
}

void RunningTones::Advance() noexcept {
  for (Index i = 0; i < count(); ++i) {
    const double sine = sine_[i];
    // Kept on the unit circle: a month has 2e10 ticks.
    const double turned = sine * turn_cosine_[i] + cosine_[i] * turn_sine_[i];
    cosine_[i] = cosine_[i] * turn_cosine_[i] - sine * turn_sine_[i];
    sine_[i] = turned;
    const double length = 1.5 - 0.5 * (sine_[i] * sine_[i] + cosine_[i] * cosine_[i]);
    sine_[i] *= length;
    cosine_[i] *= length;
  }
}

}  // namespace mjdiag
