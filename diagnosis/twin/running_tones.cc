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
  sine_ = cosine_ = turn_sine_ = turn_cosine_ = VectorXd::Zero(count);
  for (Index i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi *
                         tones_[static_cast<std::size_t>(i)].frequency * sample_time;
    turn_sine_[i] = std::sin(angle);
    turn_cosine_[i] = std::cos(angle);
  }
  Start();
}

void RunningTones::Start() noexcept {
  sine_.setZero();
  cosine_.setOnes();
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
