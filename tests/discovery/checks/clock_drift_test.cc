// Clocks that drift, and resonances that are off.

#include "mjdiag/discovery/checks/clock_drift.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "discovery/checks/checked_machine.h"
#include "mjdiag/discovery/checks/nominal_run.h"
#include "support/gaussian_noise.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using testing::ContainsRegex;
using testing::HasSubstr;

constexpr Index kSamples = 10'000;  // of 1 ms

/// A mass of 0.5 kg on a flexure, 6.7 Hz, a damping ratio of 0.5 %.
Machine Flexure(double stiffness) {
  const test::TemporaryFolder folder;
  folder.Write("plant.xml", R"(<mujoco model="flexure">
  <option timestep="0.0005" integrator="Euler" tolerance="1e-12"/>
  <worldbody><body name="stage">
    <joint name="stage" type="slide" axis="1 0 0" damping="0.2" stiffness=")" +
                                std::to_string(stiffness) + R"("/>
    <inertial pos="0 0 0" mass="0.5" diaginertia="1e-4 1e-4 1e-4"/>
  </body></worldbody>
  <actuator><motor name="coil" joint="stage"/></actuator>
  <sensor><jointpos name="encoder" joint="stage"/></sensor>
</mujoco>)");
  folder.Write("setup.toml", R"(schema = "mjdiag.setup/1"
name = "flexure"
plant = "plant.xml"
[rates]
control = 1000.0
substeps = 2
[sensors.x]
element = "encoder"
unit = "m"
[actuators.f]
element = "coil"
unit = "N"
)");
  return Machine(ReadSetup(folder.path().string()));
}

/// 20 ms each.
Excitation Strikes(const Machine& machine, const std::vector<double>& at) {
  return test::InputOf(machine, kSamples, [at](double time) {
    const bool struck = std::ranges::any_of(
        at, [time](double begin) { return time >= begin && time < begin + 0.02; });
    return struck ? 20.0 : 0.0;
  });
}

Excitation Strikes(const Machine& machine, int number) {
  std::vector<double> at;
  for (int i = 0; i < number; ++i) at.push_back(0.3 + 9.7 * i / number);
  return Strikes(machine, at);
}

Record Measured(const Machine& machine, const Excitation& excitation) {
  RunOptions options;
  options.noise_scale = 0.0;
  return test::WithChanged(Simulate(machine, excitation, options), "x",
                           [](VectorXd& x) { x += GaussianNoise(x.size(), 2e-6, 3); });
}

/// What a clock of the reading records that gains `drift` samples over the record.
Record WithDrift(const Record& record, double drift) {
  return test::WithChanged(record, "x", [drift](VectorXd& x) {
    const VectorXd before = x;
    const auto last = static_cast<double>(x.size() - 1);
    for (Index k = 0; k < x.size(); ++k) {
      const double at =
          std::clamp(static_cast<double>(k) * (1.0 + drift / last) - 0.5 * drift, 0.0,
                     last - 1e-9);
      const auto below = static_cast<Index>(at);
      const double share = at - static_cast<double>(below);
      x[k] = (1.0 - share) * before[below] + share * before[below + 1];
    }
  });
}

std::string ClocksOf(const Machine& model, const Record& record) {
  std::string notes;
  const std::string refused = test::MessageOf<InputError>([&] {
    for (const auto& note :
         CheckClocks(model, record, NominalRun(model, record, true))) {
      notes += note;
    }
    throw InputError("passes");
  });
  return refused == "passes" ? notes : refused;
}

class OffFrequency : public testing::TestWithParam<double> {};

TEST_P(OffFrequency, IsNoDriftOfClocksHoweverOftenItIsStruck) {
  const Machine model = Flexure(900.0);
  const Machine machine = Flexure(900.0 * std::pow(1.0 + GetParam(), 2));
  for (const int strikes : {1, 3, 7, 20}) {
    EXPECT_THAT(ClocksOf(model, Measured(machine, Strikes(model, strikes))),
                Not(HasSubstr("expected channels")))
        << strikes << " strikes";
  }
}

INSTANTIATE_TEST_SUITE_P(Shares, OffFrequency,
                         testing::Values(-0.07, -0.03, -0.015, -0.007, -0.003, -0.001,
                                         0.0, 0.001, 0.003, 0.007, 0.015, 0.03, 0.07));

TEST(ClockDriftCheck, FindsADriftThatStrikesShow) {
  const Machine model = Flexure(900.0);
  for (const double off : {1.0, 0.997}) {
    const Record record = Measured(Flexure(900.0 * off), Strikes(model, 20));
    EXPECT_THAT(ClocksOf(model, WithDrift(record, 11.0)),
                ContainsRegex("clocks of 'x' and 'f' drift by 1[01]\\."))
        << off;
    EXPECT_THAT(ClocksOf(model, WithDrift(record, -4.0)),
                ContainsRegex("clocks of 'x' and 'f' drift by [34]\\."))
        << off;
  }
}

TEST(ClockDriftCheck, SaysThatOneStrikeCannotTell) {
  const Machine model = Flexure(900.0);
  const Record record = Measured(model, Strikes(model, 1));
  EXPECT_EQ(ClocksOf(model, record), "");
  EXPECT_THAT(ClocksOf(model, WithDrift(record, 11.0)),
              HasSubstr("clocks of 'x' and 'f' drift is not checked: by 1"));
}

TEST(ClockDriftCheck, TakesNoFrequencyThatGoesWithTheAmplitudeForADrift) {
  const Machine model = Flexure(900.0);
  for (const char* effect :
       {"cubic_stiffness@stage:coefficient=3e6", "coulomb_friction@stage:force=0.03",
        "quadratic_drag@stage:coefficient=5"}) {
    const Machine machine = model.With(test::With({effect}));
    for (const int strikes : {1, 3, 7, 20}) {
      EXPECT_THAT(ClocksOf(model, Measured(machine, Strikes(model, strikes))),
                  Not(HasSubstr("expected channels")))
          << effect << ", " << strikes << " strikes";
    }
  }
}

}  // namespace
}  // namespace mjdiag
