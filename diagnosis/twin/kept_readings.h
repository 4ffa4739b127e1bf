#pragma once
// The last readings and commands of a run, to go back to; memory is constant. A reading
// that was not measured is NaN.

#include <Eigen/Core>
#include <algorithm>
#include <span>

namespace mjdiag {

class KeptReadings {
 public:
  KeptReadings(Eigen::Index outputs, Eigen::Index inputs, Eigen::Index capacity)
      : outputs_(Eigen::MatrixXd::Zero(outputs, capacity)),
        inputs_(Eigen::MatrixXd::Zero(inputs, capacity)) {}

  /// Those of the next tick; the oldest are lost.
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept {
    std::copy(outputs.begin(), outputs.end(), outputs_.col(Slot(added_)).begin());
    std::copy(inputs.begin(), inputs.end(), inputs_.col(Slot(added_)).begin());
    ++added_;
  }

  /// Ticks so far.
  Eigen::Index added() const { return added_; }
  /// The first tick whose readings are there.
  Eigen::Index first() const {
    return std::max<Eigen::Index>(0, added_ - outputs_.cols());
  }
  auto outputs(Eigen::Index tick) const { return outputs_.col(Slot(tick)); }
  std::span<const double> inputs(Eigen::Index tick) const {
    return {inputs_.col(Slot(tick)).data(), static_cast<std::size_t>(inputs_.rows())};
  }

 private:
  Eigen::Index Slot(Eigen::Index tick) const { return tick % outputs_.cols(); }

  Eigen::MatrixXd outputs_, inputs_;
  Eigen::Index added_ = 0;
};

}  // namespace mjdiag
