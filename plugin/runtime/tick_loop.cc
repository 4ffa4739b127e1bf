#include "mjdiag/plugin/runtime/tick_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/runtime/late_faults.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

std::unique_ptr<AxisController> MakeController(const AxisSetup& axis, ControlMode mode,
                                               double sample_time) {
  if (axis.nested) return MakeNestedLoops(*axis.nested, sample_time);
  return MakeFeedforwardFeedback(
      axis.feedforward, axis.feedback.value_or(DiscreteCompensator{{0.0}, {1.0}}),
      mode);
}

double Quantise(double value, double resolution) {
  return resolution > 0.0 ? resolution * std::round(value / resolution) : value;
}

double Clamp(double value, double limit) {
  return limit > 0.0 ? std::clamp(value, -limit, limit) : value;
}

}  // namespace

TickLoop::TickLoop(const Setup& setup, const Excitation& excitation,
                   const RunOptions& options)
    : sensors_(setup.channels.sensors),
      actuators_(setup.channels.actuators),
      reference_(excitation.reference),
      inputs_(excitation.inputs),
      feedthrough_(setup.channels.actuators.size(), nullptr),
      courses_(setup.channels.actuators.size()),
      switch_names_(setup.channels.Switches()),
      on_(setup.channels.actuators.size(), true),
      sample_time_(setup.rates.tick()),
      repeat_(options.repeat),
      noise_scale_(options.noise_scale),
      generator_(options.seed),
      observer_(options.observer),
      reconfiguration_(options.reconfiguration),
      reading_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sensors_.size()))),
      command_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(actuators_.size()))),
      readings_(reading_.size(), excitation.samples()),
      commands_(command_.size(), excitation.samples()) {
  for (const ActuatorSetup& actuator : actuators_) {
    switches_.push_back(inputs_.Find(actuator.enabled_by));
  }
  if (reference_.axes.empty()) {
    AddFeedthrough(setup);
  } else {
    AddAxes(setup, excitation, options.mode);
  }
  AddSines(setup, options);
  if (repeat_) CheckRepeatable();
  references_.resize(axes_.size());
  if (reconfiguration_ != nullptr && reconfiguration_->axes().size() != axes_.size()) {
    throw InputError("reconfiguration",
                     std::to_string(reconfiguration_->axes().size()) + " axes",
                     std::to_string(axes_.size()) + ", those of the run");
  }
}

void TickLoop::AddFeedthrough(const Setup& setup) {
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const ActuatorSetup& actuator = actuators_[i];
    feedthrough_[i] = &inputs_.At(actuator.channel);
    courses_[i] =
        InputCourse(actuator.hold, feedthrough_[i]->samples.unaryExpr([&](double u) {
          return Clamp(u, actuator.limit);
        }),
                    setup.rates.substeps);
  }
}

void TickLoop::AddAxes(const Setup& setup, const Excitation& excitation,
                       ControlMode mode) {
  CheckMode(setup.control, mode);
  for (std::size_t i = 0; i < setup.control.axes.size(); ++i) {
    const AxisSetup& axis = setup.control.axes[i];
    if (i >= reference_.axes.size() || reference_.axes[i].axis != axis.name) {
      throw InputError("reference", "no motion for axis '" + axis.name + "'",
                       "one for every axis of the setup, in its order");
    }
    Axis& entry = axes_.emplace_back();
    entry.controller = MakeController(axis, mode, sample_time_);
    const auto start = excitation.start.find(axis.sensor);
    entry.controller->Reset(start == excitation.start.end()
                                ? reference_.axes[i].position[0]
                                : start->second);
    entry.sensor = setup.channels.SensorIndex(axis.sensor);
    entry.actuator = setup.channels.ActuatorIndex(axis.actuator);
    entry.drive_gain = axis.drive_gain;
    entry.disturbance = inputs_.Find(axis.known_disturbance);
  }
}

void TickLoop::AddSines(const Setup& setup, const RunOptions& options) {
  for (const auto& [name, magnitude] : options.disturbances) {
    AddSines(setup, {{name, magnitude}, 0.0});
  }
  std::vector<LateFault> late;
  for (const LateFault& fault : options.late_faults) {
    if (IsDisturbance(setup, fault.fault.name)) late.push_back(fault);
  }
  std::stable_sort(late.begin(), late.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  for (const LateFault& fault : late) AddSines(setup, fault);
}

void TickLoop::AddSines(const Setup& setup, const LateFault& disturbance) {
  const auto& [name, magnitude] = disturbance.fault;
  const auto source = std::find_if(setup.disturbances.begin(), setup.disturbances.end(),
                                   [&n = name](const auto& d) { return d.name == n; });
  if (source == setup.disturbances.end()) {
    throw InputError("disturbance", "'" + name + "' is not one of the setup",
                     "a name under [disturbances]");
  }
  const Eigen::Index from = TickOf(disturbance, sample_time_);
  const auto which = source - setup.disturbances.begin();
  for (Sine& earlier : sines_) {
    if (earlier.source == which) earlier.until = std::min(earlier.until, from);
  }
  for (const auto& [channel, amplitude] : source->amplitude) {
    for (const double frequency : source->frequencies) {
      sines_.push_back({.source = which,
                        .actuator = setup.channels.ActuatorIndex(channel),
                        .amplitude = magnitude * amplitude,
                        .angular_frequency = 2.0 * std::numbers::pi * frequency,
                        .from = from});
    }
  }
}

void TickLoop::CheckRepeatable() const {
  constexpr double kSamePlace = 1e-12;  // m or rad
  for (const AxisReference& axis : reference_.axes) {
    const Eigen::Index last = axis.position.size() - 1;
    const double away = axis.position[last] - axis.position[0];
    if (std::abs(away) < kSamePlace && axis.velocity[last] == 0.0) continue;
    throw InputError("motion of axis '" + axis.axis + "'",
                     "does not end at rest where it begins",
                     "one that can be repeated, whole periods of it");
  }
}

void TickLoop::ReadSensors(std::span<const double> outputs) noexcept {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const double sd = noise_scale_ * sensors_[i].noise_sd;
    const double noisy = sd > 0.0 ? outputs[i] + sd * normal_(generator_) : outputs[i];
    reading_[static_cast<Eigen::Index>(i)] = Quantise(noisy, sensors_[i].resolution);
  }
}

std::span<const AxisCorrection> TickLoop::Correct(Eigen::Index k) noexcept {
  if (reconfiguration_ == nullptr) return {};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    references_[i] = reference_.axes[i].At(k);
  }
  return reconfiguration_->Correct(references_);
}

void TickLoop::Command(Eigen::Index k) noexcept {
  command_.setZero();
  for (std::size_t i = 0; i < feedthrough_.size(); ++i) {
    if (feedthrough_[i] != nullptr) {
      command_[static_cast<Eigen::Index>(i)] = feedthrough_[i]->samples[k];
    }
  }
  const std::span<const AxisCorrection> corrections = Correct(k);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& axis = axes_[i];
    double known = axis.disturbance ? axis.disturbance->samples[k] : 0.0;
    if (!corrections.empty()) {
      axis.controller->SetGain(corrections[i].gain);
      known += corrections[i].addition;
    }
    command_[axis.actuator] +=
        axis.drive_gain *
        axis.controller->Update(reference_.axes[i].At(k), reading_[axis.sensor], known);
  }
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    double& command = command_[static_cast<Eigen::Index>(i)];
    on_[i] = switches_[i] == nullptr || switches_[i]->samples[k] != 0.0;
    command = on_[i] ? Clamp(command, actuators_[i].limit) : 0.0;
  }
}

void TickLoop::Tick(std::span<const double> outputs,
                    std::span<double> inputs) noexcept {
  // Past the end of the excitation nothing is logged; its last sample is held, or it
  // begins again.
  const Eigen::Index k = repeat_ ? tick_ % ticks() : std::min(tick_, ticks() - 1);
  ReadSensors(outputs);
  Command(k);
  if (tick_ < ticks()) {
    readings_.col(k) = reading_;
    commands_.col(k) = command_;
  }
  if (observer_ != nullptr) {
    observer_->OnTick({reading_.data(), sensors_.size()},
                      {command_.data(), actuators_.size()});
  }
  std::copy(command_.begin(), command_.end(), inputs.begin());
  const double time = static_cast<double>(tick_) * sample_time_;
  for (const Sine& sine : sines_) {
    if (tick_ < sine.from || tick_ >= sine.until) continue;
    inputs[static_cast<std::size_t>(sine.actuator)] +=
        sine.amplitude * std::sin(sine.angular_frequency * time);
  }
  ++tick_;
}

Record TickLoop::ToRecord() const {
  const Eigen::Index n = std::min(tick_, ticks());
  Record record(sample_time_);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const AxisReference& axis = reference_.axes[i];
    const std::string& unit = sensors_[static_cast<std::size_t>(axes_[i].sensor)].unit;
    record.Add({axis.axis + "_ref", unit, axis.position.head(n)});
    record.Add({axis.axis + "_ref_velocity", unit + "/s", axis.velocity.head(n)});
    record.Add(
        {axis.axis + "_ref_acceleration", unit + "/s^2", axis.acceleration.head(n)});
    record.Add({axis.axis + "_ref_snap", unit + "/s^4", axis.snap.head(n)});
  }
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    record.Add({sensors_[i].channel, sensors_[i].unit,
                readings_.row(static_cast<Eigen::Index>(i)).head(n)});
  }
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    record.Add({actuators_[i].channel, actuators_[i].unit,
                commands_.row(static_cast<Eigen::Index>(i)).head(n)});
  }
  for (const std::string& name : switch_names_) {
    const Channel* known = inputs_.Find(name);
    Eigen::VectorXd on = Eigen::VectorXd::Ones(n);
    if (known != nullptr) on = known->samples.head(n);
    record.Add({name, "1", on});
  }
  for (const Axis& axis : axes_) {
    if (axis.disturbance == nullptr) continue;
    Channel known = *axis.disturbance;
    known.samples.conservativeResize(n);
    record.Add(std::move(known));
  }
  return record;
}

}  // namespace mjdiag
