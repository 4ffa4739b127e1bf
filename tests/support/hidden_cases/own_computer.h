#pragma once
// The computer of a machine whose controller is in no setup: reads the encoders with their
// noise and resolution, commands the motors, and keeps the record.

#include <Eigen/Core>
#include <functional>
#include <random>
#include <vector>

#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record.h"

namespace mjdiag::test {

class OwnComputer : public TickControl {
 public:
  /// Commands at a time, from readings and their smoothed rates.
  using Law = std::function<Eigen::VectorXd(double t, const Eigen::VectorXd& y,
                                            const Eigen::VectorXd& rate)>;

  OwnComputer(const Setup& setup, Law law, Eigen::Index ticks, std::uint64_t seed);

  void Tick(std::span<const double> outputs,
            std::span<double> inputs) noexcept override;
  Record ToRecord() const;

 private:
  double Read(std::size_t sensor, double value);

  Channels channels_;
  Law law_;
  double tick_;  // [s]
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  Eigen::Index done_ = 0;
  Eigen::VectorXd rate_;
  Eigen::MatrixXd readings_;  // sensors x ticks
  Eigen::MatrixXd commands_;  // actuators x ticks
};

}  // namespace mjdiag::test
