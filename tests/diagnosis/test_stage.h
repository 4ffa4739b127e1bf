#pragma once
// A small machine for the tests of this folder: a base on springs, a stage that slides
// freely on it against viscous friction, and a load on an elastic coupling. A motor
// drives the stage from the base, a small second one the load. Two encoders read stage
// and load against the base. 8 kHz ticks of four substeps.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/signals/simulate_lti.h"

namespace mjdiag::test {

inline constexpr TickTiming kTiming{1.0 / 32000.0, 4};
inline constexpr double kNoise = 20e-9;  ///< of each encoder, a sample [m]
/// Residuals begin at degree 3, with two relations; the four of degree 4 tell the
/// faults apart a hundred times better.
inline constexpr int kDegree = 4;
inline constexpr Eigen::Index kRelations = 4;

/// Fault parameters; 1 is healthy.
struct StageParameters {
  double damping = 1.0;    ///< of the stage's guide
  double stiffness = 1.0;  ///< of the coupling
  double gain = 1.0;       ///< of the main motor
};

/// q = positions of base, stage and load [m].
inline MechanicalModel Stage(const StageParameters& parameters = {}) {
  const auto between = [](double value) -> Eigen::Matrix2d {
    return (Eigen::Matrix2d() << value, -value, -value, value).finished();
  };
  MechanicalModel model;
  model.coordinates = {"base", "stage", "load"};
  model.inputs = {"motor", "small_motor"};
  model.outputs = {"stage", "load"};
  model.M = Eigen::Vector3d(60.0, 6.0, 1.5).asDiagonal();
  model.D = Eigen::Vector3d(8e3, 0.0, 0.0).asDiagonal();
  model.D.topLeftCorner(2, 2) += between(200.0 * parameters.damping);
  model.D.bottomRightCorner(2, 2) += between(150.0);
  model.K = Eigen::Vector3d(2e7, 0.0, 0.0).asDiagonal();
  model.K.bottomRightCorner(2, 2) += between(5e6 * parameters.stiffness);
  model.Gamma = Eigen::MatrixXd::Zero(3, 2);
  model.Gamma.col(0) = parameters.gain * Eigen::Vector3d(-1.0, 1.0, 0.0);
  model.Gamma.col(1) = Eigen::Vector3d(0.0, -1.0, 1.0);
  model.b = Eigen::MatrixXd::Zero(3, 2);
  model.b.col(0) = Eigen::Vector3d(-1.0, 1.0, 0.0);
  model.b.col(1) = Eigen::Vector3d(-1.0, 0.0, 1.0);
  return model;
}

inline const std::vector<std::string> kFaults{"damping", "stiffness", "gain"};

/// The parameters moved by `deviations`, in the order of kFaults.
inline StageParameters Moved(const Eigen::Vector3d& deviations) {
  return {1.0 + deviations[0], 1.0 + deviations[1], 1.0 + deviations[2]};
}

/// Every parameter changed by -c and +c.
inline std::vector<PerturbedModels> PerturbedStages(double magnitude = 1e-3) {
  std::vector<PerturbedModels> perturbed;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = magnitude * Eigen::Vector3d::Unit(i);
    perturbed.push_back({kFaults[static_cast<std::size_t>(i)], magnitude,
                         Stage(Moved(-step)), Stage(Moved(step))});
  }
  return perturbed;
}

inline SynthesisOptions StageOptions() {
  SynthesisOptions options;
  options.timing = kTiming;
  options.residual.degree = kDegree;
  options.residual.denominator = {5, 120.0};
  options.sensor_noise = Eigen::Vector2d::Constant(kNoise);
  return options;
}

/// Known commands [N], 2 x samples: sines of 3 to 310 Hz, and steps of the small motor.
inline Eigen::MatrixXd Drive(Eigen::Index samples) {
  Eigen::MatrixXd commands(2, samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double time = static_cast<double>(k) * kTiming.tick();
    double sum = 0.0;
    for (const double frequency : {3.0, 11.0, 37.0, 94.0, 180.0, 310.0}) {
      sum += 10.0 * std::sin(2.0 * std::numbers::pi * frequency * time);
    }
    commands(0, k) = sum;
    commands(1, k) = (k / 500) % 2 == 0 ? 0.0 : 1.0;
  }
  return commands;
}

/// z = [y; u] of the machine under those commands, without noise.
inline Eigen::MatrixXd Motion(const MechanicalModel& model,
                              const Eigen::MatrixXd& commands) {
  Eigen::MatrixXd signals(model.b.cols() + commands.rows(), commands.cols());
  signals << SimulateLti(TickModel(model, kTiming.step, kTiming.substeps), commands),
      commands;
  return signals;
}

/// White noise, rows x cols.
inline Eigen::MatrixXd WhiteNoise(Eigen::Index rows, Eigen::Index cols, double sd,
                                  std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0.0, sd);
  Eigen::MatrixXd noise(rows, cols);
  for (double& value : noise.reshaped()) value = normal(generator);
  return noise;
}

/// The same z, read by the two noisy encoders.
inline Eigen::MatrixXd Measured(Eigen::MatrixXd signals, std::uint64_t seed) {
  signals.topRows(2) += WhiteNoise(2, signals.cols(), kNoise, seed);
  return signals;
}

}  // namespace mjdiag::test
