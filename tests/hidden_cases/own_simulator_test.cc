// The simulator by which searches for causes are judged, against mjdiag's own runs in
// smaller and smaller physics steps: these are off by what is proportional to the step.

#include "support/hidden_cases/own_simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "mjdiag/plugin/runtime/simulation.h"
#include "support/bonder.h"
#include "support/changes.h"
#include "support/hidden_cases/bonder_motion.h"
#include "support/hidden_cases/bonder_run.h"
#include "support/hidden_cases/hidden_case.h"

namespace mjdiag::test {

/// What a test that failed is called by.
void PrintTo(const HiddenCase& one, std::ostream* out);
void PrintTo(const HiddenCase& one, std::ostream* out) { *out << one.name; }

namespace {

constexpr const char* kSensors[] = {"x", "y", "z"};

Trajectory Motion(const Machine& machine) {
  return BonderMotion(machine.setup(), 0.16, CaseDice("motion", 1));
}

Record MjdiagRecord(const Machine& machine, int substeps) {
  RunOptions options;
  options.noise_scale = 0.0;
  return Simulate(machine.WithSubsteps(substeps),
                  FollowTrajectory(machine.setup(), Motion(machine)), options);
}

/// What mjdiag's runs come to with shorter steps.
Record InTheLimit(const Machine& machine) {
  const Record coarse = MjdiagRecord(machine, 32);
  const Record fine = MjdiagRecord(machine, 64);
  Record limit(fine.sample_time());
  for (const char* sensor : kSensors) {
    Channel channel = fine.At(sensor);
    channel.samples += fine.At(sensor).samples - coarse.At(sensor).samples;
    limit.Add(channel);
  }
  return limit;
}

Record OwnRecord(const Machine& machine, const HiddenPhysics& hidden, int steps = 16) {
  return MeasureOwn(machine, hidden, Motion(machine),
                    {.noise_scale = 0.0, .steps = steps});
}

double Rms(const Record& one, const Record& other, const char* sensor) {
  const Eigen::VectorXd error = one.At(sensor).samples - other.At(sensor).samples;
  return std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
}

TEST(OwnSimulator, IsWhatMjdiagsRunsComeToInSmallSteps) {
  const Machine machine = Bonder({"physics.static_friction=false"});
  const Record own = OwnRecord(machine, {});
  const Record as_it_is = MjdiagRecord(machine, 4);
  const Record limit = InTheLimit(machine);
  for (const char* sensor : kSensors) {
    const double far = Rms(as_it_is, own, sensor);
    EXPECT_GT(far, 1e-7) << sensor;
    EXPECT_LT(Rms(limit, own, sensor), 1e-3 * far) << sensor;
  }
}

// MuJoCo's dry friction is a little soft, whatever its steps.
TEST(OwnSimulator, HasDryFrictionAsMjdiagUpToItsSoftness) {
  const Machine machine = Bonder();
  const Record own = OwnRecord(machine, {});
  const Record limit = InTheLimit(machine);
  EXPECT_LT(Rms(limit, own, "x"), 1e-8);
  EXPECT_LT(Rms(limit, own, "y"), 4e-8);
  EXPECT_LT(Rms(limit, own, "z"), 2e-7);
}

TEST(OwnSimulator, ConvergesWithItsOwnSteps) {
  const Machine machine = Bonder();
  const Record coarse = OwnRecord(machine, {}, 16);
  const Record fine = OwnRecord(machine, {}, 64);
  for (const char* sensor : kSensors) {
    // 20 nm and 20 nrad is the noise of the encoders.
    EXPECT_LT(Rms(coarse, fine, sensor), 2e-8) << sensor;
  }
}

TEST(OwnSimulator, RepeatsARunBitByBit) {
  const Machine machine = Bonder();
  EXPECT_EQ(OwnRecord(machine, {}).At("y").samples,
            OwnRecord(machine, {}).At("y").samples);
}

class CatalogueCase : public ::testing::TestWithParam<HiddenCase> {};

// What is hidden is written twice, here and in plugin/effects: both are the same law.
TEST_P(CatalogueCase, IsTheTruthThatItSays) {
  const Machine machine = Bonder();
  CaseDice dice(GetParam().name, 1);
  const Hidden hidden = GetParam().draw(machine, dice);
  std::vector<std::string> effects;
  for (const TrueCause& cause : hidden.truth) effects.push_back(cause.effect);
  const Machine told = machine.With(With(effects));
  const Record own = OwnRecord(machine, hidden.physics);
  const double noise = 2e-8;  // m and rad
  const Record limit = InTheLimit(told);
  const Record untold = InTheLimit(machine);
  double shown = 0.0;
  for (const char* sensor : kSensors) {
    shown = std::max(shown, Rms(untold, own, sensor) - Rms(limit, own, sensor));
    EXPECT_LT(Rms(limit, own, sensor),
              std::string(sensor) == "z" ? 10.0 * noise : 2.0 * noise)
        << sensor;
  }
  EXPECT_TRUE(effects.empty() || shown > 5.0 * noise) << shown;
}

INSTANTIATE_TEST_SUITE_P(Bonder, CatalogueCase,
                         ::testing::ValuesIn(BonderCatalogueCases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace mjdiag::test
