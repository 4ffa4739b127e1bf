#pragma once
// The sines and cosines of a machine's tones, tick after tick.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/twin/unknown.h"

namespace mjdiag {

class RunningTones {
 public:
  RunningTones(std::vector<UnknownTone> tones, double sample_time);

  Eigen::Index count() const { return sine_.size(); }
  const Eigen::VectorXd& amplitude(Eigen::Index tone) const {
    return tones_[static_cast<std::size_t>(tone)].amplitude;
  }
  double sine(Eigen::Index tone) const { return sine_[tone]; }
  double cosine(Eigen::Index tone) const { return cosine_[tone]; }

  /// To that tick: their phases are 0 at tick 0.
  void Start(Eigen::Index tick) noexcept;
  /// Adds what they put on the commands.
  /// @param parts  s and c of every tone, 2 count
  void AddTo(Eigen::VectorXd& inputs,
             const Eigen::Ref<const Eigen::VectorXd>& parts) const noexcept;
  void Advance() noexcept;

 private:
  std::vector<UnknownTone> tones_;
  Eigen::VectorXd sine_, cosine_;            // now
  Eigen::VectorXd turn_;                     // of a tick, in turns
  Eigen::VectorXd turn_sine_, turn_cosine_;  // and on the circle
};

}  // namespace mjdiag
