#pragma once
// A whole diagnosis of the test stage, made by hand.

#include "diagnosis/test_stage.h"
#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/signals/butterworth.h"

namespace mjdiag::test {

/// Residuals of unit noise; every fault; a disturbance of known waveform on both
/// commands; a detector with limits of six standard deviations.
inline DiagnosisDesign StageDesign() {
  const SynthesisOptions options = StageOptions();
  const ResidualSpace space = MakeResidualSpace(Stage(), options);
  DiagnosisDesign design;
  design.outputs = {"stage", "load"};
  design.inputs = {"motor", "small_motor"};
  design.offset = Eigen::Vector2d(0.25, -0.125);
  design.sensor_noise = options.sensor_noise;
  design.bank = SynthesiseBank(space, Eigen::MatrixXd::Identity(kRelations, kRelations),
                               PerturbedStages(), options);
  design.disturbances = {{"gamma", {60.0, 145.0}, Eigen::Vector2d(0.5, 0.2)}};
  design.disturbance.filter =
      MakeFilterBank(Combine(Eigen::MatrixXd::Identity(1, kRelations), space.relations),
                     {5, 750.0}, options.timing.tick());
  design.disturbance.high_pass =
      DigitalButterworth(FilterKind::kHighPass, 3, 100.0, options.timing.tick());
  design.decimation = 4;
  design.options.integral_window = 0.1;
  design.limits.residual.limits = {-6.0, 6.0};
  // The mean of |r| is 0.8 standard deviations.
  design.limits.integral = 2.0;
  design.limits.known = true;
  return design;
}

}  // namespace mjdiag::test
