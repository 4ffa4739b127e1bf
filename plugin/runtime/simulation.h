#pragma once
// Runs of a machine: the nonlinear plant in MuJoCo with the controllers inside the
// control callback, or the linear plant on the exact map of a control tick. Both give
// the same Record.
//
// Channels of the record, all at the control rate: every sensor channel ("x"), every
// actuator channel ("u_x"), and in closed loop the reference of every axis ("x_ref",
// "x_ref_velocity", "x_ref_acceleration", "x_ref_snap"); with log_joints every joint
// ("joint.X"). Sample k holds the sensors read at the start of tick k and the actuator
// signals held from there to tick k + 1.

#include <mujoco/mujoco.h>

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/controllers/axis_controller.h"
#include "mjdiag/controllers/reference.h"
#include "mjdiag/diagnosis/mechanical_model.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// What moves the machine in a run.
struct Excitation {
  Reference reference;  ///< of every axis in the setup's order; no axes: open loop
  /// Open loop: the actuator channels. Closed loop: known disturbances, if any.
  Record inputs;
  /// Sensor channel -> reading at rest before the first sample (left out: 0).
  std::map<std::string, double> start;

  Eigen::Index samples() const {
    return reference.axes.empty() ? inputs.samples() : reference.samples();
  }
};

/// The default or a named trajectory of the setup, as an excitation.
Excitation FollowTrajectory(const Setup& setup, const Trajectory& trajectory);
/// The same motion or input as in a measured record: closed loop if the setup has
/// controllers ("<axis>_ref" and known disturbances; logged derivatives are used if the
/// record has them, else differences), open loop otherwise (actuator channels).
/// InputError names a missing channel or a sample time that is not the control tick.
Excitation Replay(const Setup& setup, const Record& measured);

/// Sees every control tick, inside the control callback, after the sensors are read
/// and the commands computed. Nothing in it may allocate, lock, throw or do I/O.
/// This is where a diagnosis sits.
class TickObserver {
 public:
  virtual ~TickObserver() = default;
  /// @param outputs  sensor readings in the setup's order
  /// @param inputs   commanded actuator signals in the setup's order (without unknown
  ///                 disturbances)
  virtual void OnTick(std::span<const double> outputs,
                      std::span<const double> inputs) noexcept = 0;
};

struct RunOptions {
  ControlMode mode = ControlMode::kBoth;
  std::vector<Fault> faults;
  std::vector<EffectSpec> effects;
  /// Multisine disturbance -> magnitude (gamma of Eq. 7); left out: 0.
  std::map<std::string, double> disturbances;
  double noise_scale = 1.0;  ///< times every sensor's noise; 0: none
  std::uint64_t seed = 1;
  bool log_joints = false;
  TickObserver* observer = nullptr;               ///< not owned
  std::function<void(double fraction)> progress;  ///< called now and then from the run
};

/// InputError if the model's time step is not control tick / substeps, or its
/// integrator calls the control callback more than once a step.
void CheckTimeStep(const Setup& setup, const mjModel& model);

/// InputError if an axis of the setup cannot run in that mode.
void CheckMode(const Setup& setup, ControlMode mode);

/// Makes a loaded model the plant of a setup: gravity, static friction, native effects
/// that the MJCF carries, and the slot for the mark of an instance. Once a model.
void PreparePlant(const Setup& setup, mjModel& model);

/// The plant of a setup, as the setup wants it (gravity, static friction, time step).
/// InputError if the time step does not fit or an element that the setup names is
/// missing.
ModelPtr LoadPlant(const Setup& setup);

/// A copy of the plant with those faults and what of the effects is native.
ModelPtr ChangedPlant(const mjModel& plant, const std::vector<Fault>& faults,
                      const std::vector<EffectSpec>& effects);

/// Whether the run has diverged: MuJoCo resets the state then and goes on.
bool HasDiverged(const mjData& data);

/// One run of the nonlinear plant. NumericalError says at which time and joint it
/// diverged. `plant` stays as it is; faults and effects go into a copy.
Record Simulate(const Setup& setup, const mjModel& plant, const Excitation& excitation,
                const RunOptions& options);

/// The same run on the linear plant of the same MJCF (with the same faults; effects are
/// refused with InputError).
Record SimulateLinear(const Setup& setup, const mjModel& plant,
                      const Excitation& excitation, const RunOptions& options);

}  // namespace mjdiag
