#pragma once
// How well a twin explains its machine: squares of innovations, block by block, in
// units of what is expected of them (Information::Surprise).

#include <Eigen/Core>
#include <cmath>

namespace mjdiag {

class Surprise {
 public:
  /// @param tolerated  how many times larger than noise alone would have them the limits
  ///                   are, 1 or more
  explicit Surprise(Eigen::Index readings, double tolerated = 1.0)
      : readings_(readings), tolerated_(tolerated) {}

  void Start() noexcept { block_ = recent_ = 1.0; }
  void Add(double block) noexcept {
    block_ = block;
    recent_ += (block - recent_) / kRecent;
  }

  /// Of the last block.
  double block() const { return block_; }
  /// Mean over recent blocks: 1 where the twin is true.
  double recent() const { return recent_; }

  /// Neither is chance: beyond this many standard deviations.
  bool NoChance() const noexcept {
    return !(block_ < BlockLimit()) || !(recent_ < RecentLimit());
  }
  double BlockLimit() const noexcept {
    return tolerated_ * (1.0 + kHeavyTail * kNoChance * Deviation());
  }
  double RecentLimit() const noexcept {
    return tolerated_ * (1.0 + kNoChance * Deviation() / std::sqrt(kRecent / 2.0));
  }
  double tolerated() const noexcept { return tolerated_; }

 private:
  /// Blocks over which it is averaged.
  static constexpr double kRecent = 32.0;
  static constexpr double kNoChance = 8.0;
  /// A single block has the tail of chi-squared.
  static constexpr double kHeavyTail = 3.0;
  double Deviation() const noexcept {
    return std::sqrt(2.0 / static_cast<double>(readings_));
  }

  Eigen::Index readings_;
  double tolerated_;
  double block_ = 1.0;
  double recent_ = 1.0;
};

}  // namespace mjdiag
