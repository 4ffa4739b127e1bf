#include "support/hidden_cases/own_computer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mjdiag::test {

using Eigen::Index;
using Eigen::VectorXd;

OwnComputer::OwnComputer(const Setup& setup, Law law, Index ticks, std::uint64_t seed)
    : channels_(setup.channels),
      law_(std::move(law)),
      tick_(setup.rates.tick()),
      generator_(seed),
      rate_(VectorXd::Zero(static_cast<Index>(channels_.sensors.size()))),
      readings_(rate_.size(), ticks),
      commands_(static_cast<Index>(channels_.actuators.size()), ticks) {}

double OwnComputer::Read(std::size_t sensor, double value) {
  const SensorSetup& setup = channels_.sensors[sensor];
  const double noisy = value + setup.noise_sd * normal_(generator_);
  return setup.resolution > 0.0
             ? setup.resolution * std::round(noisy / setup.resolution)
             : noisy;
}

void OwnComputer::Tick(std::span<const double> outputs,
                       std::span<double> inputs) noexcept {
  constexpr double kCutoff = 40.0;  // Hz, of the rates
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    readings_(static_cast<Index>(i), done_) = Read(i, outputs[i]);
  }
  const VectorXd y = readings_.col(done_);
  if (done_ > 0) {
    const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * kCutoff * tick_);
    rate_ += share * ((y - readings_.col(done_ - 1)) / tick_ - rate_);
  }
  commands_.col(done_) = law_(tick_ * static_cast<double>(done_), y, rate_);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    inputs[i] = commands_(static_cast<Index>(i), done_);
  }
  ++done_;
}

Record OwnComputer::ToRecord() const {
  Record record(tick_);
  for (std::size_t i = 0; i < channels_.sensors.size(); ++i) {
    const SensorSetup& sensor = channels_.sensors[i];
    record.Add({sensor.channel, sensor.unit,
                readings_.row(static_cast<Index>(i)).head(done_)});
  }
  for (std::size_t i = 0; i < channels_.actuators.size(); ++i) {
    const ActuatorSetup& actuator = channels_.actuators[i];
    record.Add({actuator.channel, actuator.unit,
                commands_.row(static_cast<Index>(i)).head(done_)});
  }
  return record;
}

}  // namespace mjdiag::test
