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

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/controllers/axis_controller.h"
#include "mjdiag/controllers/reconfiguration.h"
#include "mjdiag/controllers/reference.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/machine/plant_state.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// What moves the machine in a run.
struct Excitation {
  Reference reference;  ///< of every axis in the setup's order; no axes: open loop
  /// Open loop: the actuator channels. Closed loop: known disturbances, if any. Both:
  /// the switches of actuators, if any; without them the actuators are on.
  Record inputs;
  /// Sensor channel -> reading at rest before the first sample (left out: 0).
  std::map<std::string, double> start;
  /// In its place: where the machine is then, and how it moves. Of the nonlinear plant.
  std::optional<PlantState> state = {};

  Eigen::Index samples() const {
    return reference.axes.empty() ? inputs.samples() : reference.samples();
  }
};

/// A trajectory, as an excitation.
Excitation FollowTrajectory(const Setup& setup, const Trajectory& trajectory);
/// The default trajectory of the setup. InputError if it has none.
Excitation DefaultMotion(const Setup& setup);
/// The same motion or input as in a measured record: closed loop if the setup has
/// controllers ("<axis>_ref" and known disturbances; logged derivatives are used if the
/// record has them, else differences), open loop otherwise (actuator channels).
/// Switches of actuators that the record lacks are on.
/// InputError names a missing channel or a sample time that is not the control tick.
Excitation Replay(const Setup& setup, const Record& measured);
/// The setup without its controllers: a replay on it drives the actuators with what was
/// measured.
Setup WithoutControllers(Setup setup);

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

/// A fault parameter or a disturbance that has another value from a time on; the tick
/// nearest to it is the first of it. What it had before may come back the same way.
struct LateFault {
  Fault fault;
  double time = 0.0;  ///< [s] since the start of the run
  /// Time in which it becomes that, evenly [s]; 0: at once, as a disturbance always does.
  double growth = 0.0;
};

struct RunOptions {
  ControlMode mode = ControlMode::kBoth;
  /// Multisine disturbance -> magnitude (gamma of Eq. 7); left out: 0.
  std::map<std::string, double> disturbances;
  std::vector<LateFault> late_faults;
  /// When the motion ends it begins again, for ever; what is logged is its first time.
  bool repeat = false;
  double noise_scale = 1.0;  ///< times every sensor's noise; 0: none
  /// The linear plant without the effects that the plant carries beside: else they are
  /// refused.
  bool linear_part = false;
  std::uint64_t seed = 1;
  bool log_joints = false;
  TickObserver* observer = nullptr;  ///< not owned
  /// Corrects what the controllers command; somebody, for example the observer, tells it
  /// every tick what it knows of the faults. Not owned.
  Reconfiguration* reconfiguration = nullptr;
  std::function<void(double fraction)> progress;  ///< called now and then from the run
};

/// InputError if an axis cannot run in that mode.
void CheckMode(const Control& control, ControlMode mode);

/// One run of the nonlinear machine. NumericalError says at which time and joint it
/// diverged.
Record Simulate(const Machine& machine, const Excitation& excitation,
                const RunOptions& options);

/// The same run of the linear model of the machine; effects that it was given besides
/// those of its MJCF, and effects that are not linear, are refused with InputError.
Record SimulateLinear(const Machine& machine, const Excitation& excitation,
                      const RunOptions& options);

}  // namespace mjdiag
