#pragma once
// One running machine: the state that MuJoCo's control callback works on. The callback
// is global to the process; which instance an mjData belongs to is written in the data
// itself, in the last two slots of mjData.userdata. Instances share nothing, so several
// may run in parallel threads.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/plugin/runtime/tick_loop.h"

namespace mjdiag {

class Instance {
 public:
  Instance(const Machine& machine, const Excitation& excitation,
           const RunOptions& options);

  /// Called by the control callback once a physics step: at the first step of a tick it
  /// reads the sensors and computes the commands, which hold for the tick; effects act
  /// in every step.
  void OnStep(const mjModel& model, mjData& data) noexcept;

  /// Sets the actuators and the forces of effects to zero.
  void Release(mjData& data) noexcept;

  const TickLoop& loop() const { return loop_; }
  /// The ticks so far, with the joints if they are logged.
  Record ToRecord(const mjModel& model) const;

 private:
  void LogJoints(const mjModel& model, const mjData& data) noexcept;

  TickLoop loop_;
  Stepper stepper_;
  Eigen::MatrixXd joints_;  // nq x ticks, empty: not logged
};

/// Marks the data as belonging to the instance and installs the control callback (once
/// a process; data without a mark go to the callback that was installed before).
/// InputError if the model has no slot. mj_resetData takes the mark off, mj_copyData
/// keeps it.
void Attach(const mjModel& model, mjData& data, Instance& instance);
void Detach(const mjModel& model, mjData& data);

}  // namespace mjdiag
