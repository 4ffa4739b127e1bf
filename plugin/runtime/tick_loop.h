#pragma once
// One control tick of a machine, the same for every kind of physics behind it: add
// sensor noise, run the controllers, add disturbances, log, let the observer see it.
// Everything is allocated in the constructor.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "mjdiag/controllers/axis_controller.h"
#include "mjdiag/plugin/machine/input_course.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class TickLoop : public TickControl {
 public:
  /// InputError if the excitation lacks an axis or an actuator channel of the setup,
  /// options.disturbances names none of its disturbances, or a motion that is to be
  /// repeated does not end where it begins.
  TickLoop(const Setup& setup, const Excitation& excitation, const RunOptions& options);

  /// @param outputs  true sensor readings at the start of the tick, setup order
  /// @param inputs   receives the actuator signals to hold until the next tick
  void Tick(std::span<const double> outputs,
            std::span<double> inputs) noexcept override;
  double Above(std::size_t actuator, int substep) const noexcept override {
    return courses_[actuator].Above(tick_ - 1, substep);
  }
  bool IsOn(std::size_t actuator) const noexcept override { return on_[actuator]; }

  Eigen::Index ticks_done() const { return tick_; }
  Eigen::Index ticks() const { return readings_.cols(); }

  /// Sensors, actuators, their switches and references of the ticks so far.
  Record ToRecord() const;

 private:
  struct Axis {
    std::unique_ptr<AxisController> controller;
    Eigen::Index sensor = 0;
    Eigen::Index actuator = 0;
    double drive_gain = 1.0;
    const Channel* disturbance = nullptr;  // in inputs_
  };
  struct Sine {
    std::ptrdiff_t source = 0;  // disturbance of the setup
    Eigen::Index actuator = 0;
    double amplitude = 0.0;
    double angular_frequency = 0.0;
    Eigen::Index from = 0;
    Eigen::Index until = std::numeric_limits<Eigen::Index>::max();
  };

  void AddFeedthrough(const Setup& setup);
  void AddAxes(const Setup& setup, const Excitation& excitation, ControlMode mode);
  void AddSines(const Setup& setup, const RunOptions& options);
  void AddSines(const Setup& setup, const LateFault& disturbance);
  void CheckRepeatable() const;
  void ReadSensors(std::span<const double> outputs) noexcept;
  void Command(Eigen::Index k) noexcept;
  /// What the reconfiguration adds to the command of every axis; its gains are set.
  std::span<const AxisCorrection> Correct(Eigen::Index k) noexcept;

  std::vector<SensorSetup> sensors_;
  std::vector<ActuatorSetup> actuators_;
  Reference reference_;
  Record inputs_;
  std::vector<const Channel*> feedthrough_;  // per actuator: driven from inputs_
  std::vector<InputCourse> courses_;         // per actuator, of what is fed through
  std::vector<const Channel*> switches_;     // per actuator; null: always on
  std::vector<std::string> switch_names_;
  std::vector<bool> on_;  // per actuator, this tick
  std::vector<Axis> axes_;
  std::vector<Sine> sines_;
  double sample_time_;
  bool repeat_;
  double noise_scale_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  TickObserver* observer_;
  Reconfiguration* reconfiguration_;
  std::vector<ReferenceSample> references_;  // this tick
  Eigen::Index tick_ = 0;
  Eigen::VectorXd reading_;   // this tick, with noise
  Eigen::VectorXd command_;   // this tick, without unknown disturbances
  Eigen::MatrixXd readings_;  // sensors x ticks
  Eigen::MatrixXd commands_;  // actuators x ticks
};

}  // namespace mjdiag
