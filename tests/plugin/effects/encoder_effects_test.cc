// Errors of encoders, on readings and in runs.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "support/any_machine.h"
#include "support/bonder.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

Setup Emps() { return ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"); }

/// Readings of x, y and z of the bonder with one effect.
std::array<double, 3> Read(const std::string& effect, std::array<double, 3> readings,
                           double time) {
  const Machine bonder = test::Bonder();
  const DataPtr data = MakeData(bonder.plant());
  ActiveEffects(bonder.channels(), bonder.plant(), {ParseEffect(effect)})
      .Distort(bonder.plant(), *data, readings, time);
  return readings;
}

TEST(EncoderEffects, ScaleMultipliesItsOwnEncoderOnly) {
  EXPECT_EQ(Read("encoder_scale@y_encoder:factor=1.5", {0.1, 0.2, 0.3}, 7.0),
            (std::array{0.1, 1.5 * 0.2, 0.3}));
}

// Of a tendon over two joints, a second encoder: both move.
TEST(EncoderEffects, DelayReadsWhereTheMachineWasAMomentAgo) {
  const Machine emps(Emps());
  const DataPtr data = MakeData(emps.plant());
  data->qvel[0] = 0.25;
  std::array<double, 1> readings{0.2};
  ActiveEffects effects(emps.channels(), emps.plant(),
                        {ParseEffect("encoder_delay@load_encoder:delay=0.004")});
  effects.Distort(emps.plant(), *data, readings, 0.0);
  EXPECT_EQ(readings[0], 0.2 - 0.004 * 0.25);
}

// The command of a tick acts behind its reading: what is read is wound up by the one before.
TEST(EncoderEffects, WindupReadsWhatTheForceOfTheLastStepMakesOfItsTransmission) {
  const Machine emps(Emps());
  const DataPtr data = MakeData(emps.plant());
  ActiveEffects effects(
      emps.channels(), emps.plant(),
      {ParseEffect("transmission_windup@load_encoder:compliance=2e-6")});
  mj_fwdPosition(&emps.plant(), data.get());
  mj_fwdVelocity(&emps.plant(), data.get());
  const auto read = [&] {
    std::array<double, 1> readings{0.2};
    effects.Distort(emps.plant(), *data, readings, 0.0);
    return readings[0];
  };
  EXPECT_EQ(read(), 0.2);
  data->ctrl[0] = 1.5;
  EXPECT_EQ(read(), 0.2);
  effects.Act(emps.plant(), *data);
  mj_fwdActuation(&emps.plant(), data.get());
  EXPECT_NEAR(read(), 0.2 + 2e-6 * data->qfrc_actuator[0], 1e-15);
  EXPECT_GT(read(), 0.2);
}

TEST(EncoderEffects, WindupIsOfTheEncoderOfAJoint) {
  const Machine bonder = test::Bonder();
  EXPECT_THROW(
      ActiveEffects(bonder.channels(), bonder.plant(),
                    {ParseEffect("transmission_windup@x_encoder:compliance=1")}),
      InputError);
}

// Its encoders are sites on moving scales: what is read a moment later is what the rate says.
TEST(EncoderEffects, DelayOfAFrameReadsWhereItWasInItsReference) {
  const Machine bonder = test::Bonder();
  const DataPtr data = MakeData(bonder.plant());
  for (int dof = 0; dof < bonder.plant().nv; ++dof) {
    data->qvel[dof] = 0.01 * (dof % 3 - 1) + 0.002 * dof;
  }
  ActiveEffects effects(bonder.channels(), bonder.plant(),
                        {ParseEffect("encoder_delay@y_encoder:delay=1e-6")});
  const auto read = [&] {
    mj_forward(&bonder.plant(), data.get());
    return data->sensordata[bonder.sensor_addresses()[1]];
  };
  const double now = read();
  std::array<double, 3> readings{0.0, now, 0.0};
  effects.Distort(bonder.plant(), *data, readings, 0.0);
  mj_integratePos(&bonder.plant(), data->qpos, data->qvel, -1e-6);
  EXPECT_NEAR(readings[1], read(), 1e-12);
  EXPECT_GT(std::abs(readings[1] - now), 1e-9);
  EXPECT_EQ(readings[0], 0.0);
}

TEST(EncoderEffects, HaveUnitsOfAnAngleWhereHingesAreRead) {
  const Machine arm = test::MachineOf(
      R"(<mujoco><worldbody><body><joint name="motor" type="hinge"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><body>
      <joint name="flex" type="hinge" stiffness="9"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></body></worldbody>
      <tendon><fixed name="both"><joint joint="motor" coef="1"/>
      <joint joint="flex" coef="1"/></fixed></tendon>
      <actuator><motor name="u" joint="motor"/></actuator>
      <sensor><jointpos name="own" joint="motor"/><tendonpos name="link" tendon="both"/>
      </sensor></mujoco>)",
      "[rates]\ncontrol = 500.0\n[sensors.q]\nelement = \"own\"\nunit = \"rad\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n");
  const Effect& error = FindEffect("encoder_periodic_error");
  for (const char* encoder : {"own", "link"}) {
    EXPECT_EQ(SiteUnit(arm.plant(), error, encoder, error.parameters()[0]), "rad");
  }
  EXPECT_EQ(
      SiteUnit(Machine(Emps()).plant(), error, "load_encoder", error.parameters()[0]),
      "m");
}

TEST(EncoderEffects, PeriodicErrorRepeatsWithItsPeriod) {
  const std::string effect =
      "encoder_periodic_error@x_encoder:amplitude=2e-7,period=2e-5,phase=0.5";
  for (const double y : {0.0, 3e-6, 1.1e-5, -4.2e-3}) {
    const double error = 2e-7 * std::sin(2.0 * std::numbers::pi * y / 2e-5 + 0.5);
    EXPECT_NEAR(Read(effect, {y, 0.0, 0.0}, 0.0)[0], y + error, 1e-15);
    EXPECT_NEAR(Read(effect, {y + 2e-5, 0.0, 0.0}, 0.0)[0], y + 2e-5 + error, 1e-15);
  }
}

TEST(EncoderEffects, DriftGrowsWithTime) {
  EXPECT_EQ(Read("encoder_drift@z_encoder:rate=-2e-6", {0.1, 0.2, 0.3}, 4.0),
            (std::array{0.1, 0.2, 0.3 - 8e-6}));
}

// The controller holds the distorted reading on its reference, so the load itself goes
// the other way: 0.2 m / 1.001.
TEST(EncoderEffects, AreWhatTheControllerSees) {
  const Machine machine(Emps());
  RunOptions options;
  options.log_joints = true;
  Trajectory motion = machine.setup().trajectories.Find("default");
  motion.duration = 2.6;
  const Record record =
      Simulate(machine.With(test::With({"encoder_scale@load_encoder:factor=1.001"})),
               FollowTrajectory(machine.setup(), motion), options);
  const Eigen::Index last = record.samples() - 1;
  EXPECT_NEAR(record.At("q").samples[last], 0.2, 1e-6);
  EXPECT_NEAR(record.At("joint.load").samples[last], 0.2 / 1.001, 1e-6);
}

/// What the encoder of EMPS reads while the load rests without input.
Eigen::VectorXd AtRest(const std::vector<std::string>& effects, double own_noise) {
  Setup setup = Emps();
  setup.control.axes.clear();
  setup.channels.sensors[0].noise_sd = own_noise;
  Excitation rest;
  rest.inputs = Record(setup.rates.tick());
  rest.inputs.Add({"u", "V", Eigen::VectorXd::Zero(4000)});
  const Machine machine = Machine(setup).With(test::With(effects));
  return Simulate(machine, rest, {}).At("q").samples;
}

// The standard deviation of 4000 samples is known to 1 / sqrt(2 * 4000) = 1.1 %: bounds
// of four times that. Two noises add as squares.
TEST(EncoderEffects, NoiseIsWhiteAndBesideTheSensorsOwn) {
  const Eigen::VectorXd noise = AtRest({"encoder_noise@load_encoder:sd=3e-6"}, 4e-6);
  const double bound = 4.0 / std::sqrt(2.0 * 4000.0);
  const double sd = std::sqrt(noise.squaredNorm() / 4000.0);
  EXPECT_NEAR(sd / 5e-6, 1.0, bound);
  // Correlation of neighbours: standard deviation 1 / sqrt(4000).
  const double correlation =
      noise.head(3999).dot(noise.tail(3999)) / noise.squaredNorm();
  EXPECT_NEAR(correlation, 0.0, 4.0 / std::sqrt(4000.0));
}

TEST(EncoderEffects, NoiseIsAbsentWithoutAnEffect) {
  EXPECT_EQ(AtRest({}, 0.0).lpNorm<Eigen::Infinity>(), 0.0);
}

}  // namespace
}  // namespace mjdiag
