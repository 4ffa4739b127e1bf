#pragma once
// A discovery for the tests of this folder: Coulomb friction and a motor that is too
// strong, found on the record of a slide.

#include <cmath>
#include <limits>
#include <numbers>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/fault_effect.h"

namespace mjdiag {

inline Eigen::VectorXd SampleSine(double amplitude) {
  constexpr Eigen::Index kSamples = 2000;
  return Eigen::VectorXd::NullaryExpr(kSamples, [amplitude](Eigen::Index k) {
    return amplitude *
           std::sin(2.0 * std::numbers::pi * static_cast<double>(k) / 500.0);
  });
}

/// Mismatch of q with that amplitude; u fits.
inline Comparison SampleReplay(double mismatch) {
  Comparison comparison;
  comparison.setup = "slide <1>";
  comparison.options.skip_samples = 10;
  comparison.measured = Record(1e-3);
  comparison.simulated = Record(1e-3);
  const Eigen::VectorXd position = SampleSine(1e-2);
  comparison.measured.Add({"q", "m", position + SampleSine(mismatch)});
  comparison.simulated.Add({"q", "m", position});
  const NoiseFloor floor{1e-7, 2000, 2000};
  comparison.channels.push_back(MeasureMismatch(
      comparison.measured, comparison.simulated, "q", floor, comparison.options));
  comparison.derived = {{"force", "N", 2.0, 1e6 * mismatch}};
  return comparison;
}

inline FoundCause SampleFriction() {
  FoundCause friction;
  friction.cause = ParseEffect("coulomb_friction@load:force=20.39");
  friction.parameters = {{"force", "N", 20.39, 0.094, 20.206, 20.574}};
  friction.probability = 0.963;
  friction.alternatives = {
      {ParseEffect("stribeck_friction@load:coulomb=19,breakaway=2,velocity=0.01"),
       0.031, false},
      {ParseEffect("presliding_hysteresis@load:force=20,stiffness=1e6"), 0.006, false}};
  return friction;
}

inline FoundCause SampleFault() {
  FoundCause fault;
  fault.cause = {FaultEffect({"eta", ModelParameterKind::kGear, {0}}), "drive",
                 Eigen::VectorXd::Constant(1, 1.0342)};
  fault.parameters = {{"value", "1", 1.0342, 2e-5, 1.03416, 1.03424}};
  fault.probability = 1.0;
  fault.alternatives = {{ParseEffect("motor_constant@drive:factor=1.0342"), 0.5, true}};
  return fault;
}

inline LawPlot SampleLaw() {
  LawPlot law;
  law.cause = "coulomb_friction";
  law.site = "load";
  law.x_name = "velocity of load";
  law.x_unit = "m/s";
  law.y_unit = "N";
  law.x = SampleSine(0.1);
  law.y = -20.0 * law.x.array().sign() + 3.0 * SampleSine(1.0).array().cos();
  law.law_x = Eigen::Vector4d(-0.1, -1e-6, 1e-6, 0.1);
  law.law_y = Eigen::Vector4d(20.39, 20.39, -20.39, -20.39);
  return law;
}

inline Discovery SampleDiscovery() {
  Discovery discovery;
  discovery.setup = "slide <1>";
  discovery.verdict = DiscoveryVerdict::kExplained;
  discovery.causes = {SampleFriction(), SampleFault()};
  discovery.kinds = {{Kind::kDryFriction, "load", 0.998, 0.62}};
  discovery.notes = {"backlash at load cannot be judged: it is never reversed."};
  discovery.train_share = 0.7;
  discovery.records = {{"slide.csv", true, SampleReplay(5e-6), SampleReplay(1e-7)}};
  discovery.mismatch_before = {{{"q", 3.5e-6}}, {{"q", 4e-6}}};
  discovery.mismatch_after = {{{"q", 1.0e-7}}, {{"q", 1.1e-7}}};
  discovery.noise_floor = {{"q", 1e-7}};
  discovery.unit = {{"q", "m"}};
  discovery.gain_train = 0.971;
  discovery.gain_validation = 0.9725;
  discovery.colour_before = 0.8;
  discovery.colour_after = 0.01;
  discovery.ladder = {
      {"nothing", 35.0, 40.0, {{"force", 39.2}, {"q", 0.5}}, {{"force", 17.0}}},
      {"coulomb_friction@load",
       1.2,
       1.3,
       {{"force", 4.6}, {"q", 0.01}},
       {{"force", 6.0}}}};
  discovery.forces_before = {{"load", "N", SampleSine(20.0), 14.0, 0.8, 0.01}};
  discovery.forces_after = {{"load", "N", SampleSine(0.5), 0.35, 0.4, 0.01}};
  discovery.laws = {SampleLaw()};
  discovery.fault_limits = {{"zeta", 0.2, 0.01},
                            {"beta", std::numeric_limits<double>::infinity(), 0.5}};
  discovery.sample_time = 1e-3;
  return discovery;
}

/// What is left of it depends on the position, in a form that no cause has.
inline Discovery SampleUnexplained() {
  Discovery discovery = SampleDiscovery();
  discovery.verdict = DiscoveryVerdict::kUnexplained;
  discovery.causes.clear();
  discovery.laws.clear();
  discovery.records.front().after = discovery.records.front().before;
  ResidualDependence signature;
  signature.site = "load";
  signature.variable = "position of load";
  signature.unit = "m";
  signature.shape = "fourth power";
  signature.explained_share = 0.83;
  signature.significant = true;
  signature.exponent = 4.0;
  signature.runner_up = "time";
  signature.runner_up_share = 0.1;
  signature.x = Eigen::VectorXd::LinSpaced(40, -0.1, 0.1);
  signature.y = 2e5 * signature.x.array().pow(4);
  signature.y_sd = Eigen::VectorXd::Constant(40, 0.5);
  signature.text = "The force that is left at load is a fourth power of its position.";
  discovery.unexplained = signature;
  discovery.unexplained_site = "load";
  return discovery;
}

}  // namespace mjdiag
