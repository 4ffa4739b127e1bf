#pragma once
// How well a twin explains its machine: squares of innovations, block by block, in
// units of what is expected of them (Information::NormalizedInnovation).

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace mjdiag {

class NormalizedInnovation {
 public:
  /// @param block      ticks of one
  /// @param tolerated  how many times larger than noise alone would have them the limits
  ///                   are, 1 or more
  explicit NormalizedInnovation(Eigen::Index readings, Eigen::Index block,
                                double tolerated = 1.0)
      : readings_(readings),
        blocks_(std::max(kRecent / static_cast<double>(block), 1.0)),
        tolerated_(tolerated) {}

  void Start() noexcept { block_ = recent_ = 1.0; }
  void Add(double block) noexcept {
    block_ = block;
    recent_ += (block - recent_) / blocks_;
  }

  /// Of the last block.
  double block() const { return block_; }
  /// Mean over recent blocks: 1 where the twin is true.
  double recent() const { return recent_; }

  /// Neither is chance: beyond this many standard deviations.
  bool NoChance() const noexcept { return !(Excess() < 1.0); }
  /// Of both over these limits.
  double Excess() const noexcept {
    return std::max(block_ / BlockLimit(), recent_ / RecentLimit());
  }

 private:
  /// Ticks over which it is averaged.
  static constexpr double kRecent = 256.0;
  static constexpr double kNoChance = 8.0;
  /// A single block has the tail of chi-squared.
  static constexpr double kHeavyTail = 3.0;
  double BlockLimit() const noexcept {
    return tolerated_ * (1.0 + kHeavyTail * kNoChance * Deviation());
  }
  double RecentLimit() const noexcept {
    return tolerated_ * (1.0 + kNoChance * Deviation() / std::sqrt(blocks_ / 2.0));
  }
  double Deviation() const noexcept {
    return std::sqrt(2.0 / static_cast<double>(readings_));
  }

  Eigen::Index readings_;
  double blocks_;
  double tolerated_;
  double block_ = 1.0;
  double recent_ = 1.0;
};

}  // namespace mjdiag
