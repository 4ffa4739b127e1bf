#pragma once
// A machine whose records are checked, and records with something wrong.

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/checks/data_check.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "support/changes.h"
#include "support/message_of.h"

namespace mjdiag::test {

/// A machine with its default run as the measured record.
struct CheckedMachine {
  Machine machine;

  explicit CheckedMachine(const std::string& name,
                          const std::vector<std::string>& overrides = {})
      : machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/" + name, overrides)) {}

  Machine With(const std::string& effect) const {
    return effect.empty() ? machine : machine.With(test::With({effect}));
  }
  Record Run(const std::string& effect = "", double noise_scale = 1.0) const {
    const Trajectories& motions = machine.setup().trajectories;
    return Run(FollowTrajectory(machine.setup(), motions.Find(motions.fallback)),
               effect, noise_scale);
  }
  Record Run(const Excitation& excitation, const std::string& effect,
             double noise_scale = 1.0) const {
    RunOptions options;
    options.noise_scale = noise_scale;
    return Simulate(With(effect), excitation, options);
  }
  std::vector<std::string> Check(const Record& record) const {
    return CheckRecord(machine, record);
  }
  std::string Refusal(const Record& record) const {
    return MessageOf<InputError>([&] { Check(record); });
  }
};

/// The same record with one channel changed.
inline Record WithChanged(const Record& record, const std::string& name,
                          const std::function<void(Eigen::VectorXd&)>& change) {
  Record changed(record.sample_time(), record.start_time());
  for (Channel channel : record.channels()) {
    if (channel.name == name) change(channel.samples);
    changed.Add(std::move(channel));
  }
  return changed;
}

inline Record Scaled(const Record& record, const std::string& name, double factor) {
  return WithChanged(record, name, [&](Eigen::VectorXd& x) { x *= factor; });
}

/// One actuator channel over time, as an excitation of an open loop.
inline Excitation InputOf(const Machine& machine, Eigen::Index samples,
                          const std::function<double(double time)>& input) {
  const ActuatorSetup& actuator = machine.channels().actuators.front();
  const double tick = machine.rates().tick();
  Excitation excitation;
  excitation.inputs = Record(tick);
  excitation.inputs.Add({actuator.channel, actuator.unit,
                         Eigen::VectorXd::NullaryExpr(samples, [&](Eigen::Index k) {
                           return input(static_cast<double>(k) * tick);
                         })});
  return excitation;
}

}  // namespace mjdiag::test
