#pragma once
// The stage of test_stage.h as a machine of which nothing is sure: its three fault
// parameters, a tone of 90 Hz on its motor, and where it starts.

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "diagnosis/test_stage.h"
#include "mjdiag/diagnosis/twin/linear_twin.h"
#include "mjdiag/diagnosis/twin/twin_estimator.h"

namespace mjdiag::test {

inline constexpr double kTone = 90.0;  // Hz
inline constexpr Eigen::Index kBlock = 8;
inline const Eigen::Vector2d kToneAmplitude{10.0, 0.0};  // N

inline UncertainModel UncertainStage() {
  UncertainModel model;
  model.nominal = Stage();
  model.timing = kTiming;
  model.rest = Eigen::Vector2d(0.1, -0.2);
  for (int i = 0; i < 3; ++i) {
    const MechanicalModel moved = Stage(Moved(Eigen::Vector3d::Unit(i)));
    model.parts.push_back({{},
                           moved.D - model.nominal.D,
                           moved.K - model.nominal.K,
                           moved.Gamma - model.nominal.Gamma,
                           {},
                           {i}});
    model.unknowns.push_back(
        {kFaults[static_cast<std::size_t>(i)], 0.0, 0.1, 1.0, true});
  }
  model.tones.push_back({kTone, kToneAmplitude});
  model.unknowns.push_back({"sine", 0.0, 0.1, 0.0, true});
  model.unknowns.push_back({"cosine", 0.0, 0.1, 0.0, true});
  model.start = StartDirections(model.nominal, 1.0);
  for (Eigen::Index i = 0; i < model.start.cols(); ++i) {
    model.unknowns.push_back({"start " + std::to_string(i), 0.0, 1.0, 0.0, false});
  }
  return model;
}

inline constexpr Eigen::Index kOfTheMachine =
    5;  ///< unknowns before those of the start

/// Readings and commands of a stage with these deviations and that tone.
struct StageRun {
  Eigen::MatrixXd outputs;
  Eigen::MatrixXd inputs;
};

inline StageRun RunStage(const Eigen::Vector3d& deviations, double tone,
                         std::uint64_t seed, Eigen::Index samples = 8000) {
  StageRun run;
  run.inputs = Drive(samples);
  Eigen::MatrixXd driven = run.inputs;
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double angle =
        2.0 * std::numbers::pi * kTone * static_cast<double>(k) * kTiming.tick();
    driven.col(k) += tone * std::sin(angle + 1.0) * kToneAmplitude;
  }
  run.outputs = SimulateLti(
      TickModel(Stage(Moved(deviations)), kTiming.step, kTiming.substeps), driven);
  run.outputs.colwise() += UncertainStage().rest;
  run.outputs += WhiteNoise(2, samples, kNoise, seed);
  return run;
}

inline TwinEstimator StageEstimator(const PredictionErrorOptions& options = {}) {
  const UncertainModel model = UncertainStage();
  // A gain that settles within the time given to it: 60 Hz, damped.
  Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(6, 2);
  const double omega = 2.0 * std::numbers::pi * 60.0;
  gain.topRows(3) = 1.4 * omega * kTiming.tick() * PlacementOf(model.nominal);
  gain.bottomRows(3) = omega * omega * kTiming.tick() * PlacementOf(model.nominal);
  MachineTwin twin;
  const Eigen::MatrixXd noise = kNoise * kNoise * Eigen::MatrixXd::Identity(2, 2);
  twin.twin = std::make_unique<LinearTwin>(
      model,
      std::vector<TwinGain>{{Eigen::MatrixXd::Zero(6, 2), noise, 0},
                            {gain, 1.2 * noise, 400}},
      kBlock);
  twin.unknowns = model.unknowns;
  for (Eigen::Index i = 0; i < 3; ++i) {
    twin.faults.push_back({kFaults[static_cast<std::size_t>(i)], i, {}});
  }
  twin.faults.push_back({"tone", 3, {kTone}});
  twin.sample_time = kTiming.tick();
  return {std::move(twin), options};
}

inline void Listen(TwinEstimator& estimator, const StageRun& run,
                   Eigen::Index from = 0) {
  for (Eigen::Index k = from; k < run.outputs.cols(); ++k) {
    estimator.Add({run.outputs.col(k).data(), 2}, {run.inputs.col(k).data(), 2});
  }
}

}  // namespace mjdiag::test
