// Machines that are no tree of slides and hinges that motors push: what they lack is found by
// the same path.

#include "support/any_machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using ::testing::ElementsAre;

Machine MachineOf(const std::string& model, const std::string& sensor) {
  return test::MachineOf("<mujoco><compiler angle=\"radian\"/>" + model + "</mujoco>",
                         "[rates]\ncontrol = 500.0\nsubsteps = 2\n[sensors.y]\n" +
                             sensor +
                             "\n[actuators.u]\nelement = \"u\"\nunit = \"1\"\n");
}

class Commands final : public TickControl {
 public:
  void Tick(std::span<const double>, std::span<double> inputs) noexcept override {
    inputs[0] = now;
  }
  double now = 0.0;
};

/// What the sensor of a machine reads from rest on, in steps a tenth as long.
Record Measure(const Machine& machine, const std::function<double(double)>& command,
               double noise, int substeps = 20, Index samples = 4000) {
  const Machine truth = machine.WithSubsteps(substeps);
  TickMap map(truth);
  Commands commands;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const mjModel& model = map.model();
  PlantState state =
      map.Begun({truth.rest(), VectorXd::Zero(model.nv), VectorXd::Zero(model.na)});
  const VectorXd none = VectorXd::Zero(model.nv);
  VectorXd y(samples), u(samples);
  for (Index k = 0; k < samples; ++k) {
    commands.now = u[k] = command(2e-3 * static_cast<double>(k));
    y[k] = map.Read(state, k)[0] + noise * normal(random);
    state = map.Run(state, none, k, commands).state;
  }
  Record record(2e-3, 0.0);
  record.Add({"y", machine.channels().sensors[0].unit, y});
  record.Add({"u", "1", u});
  return record;
}

Discovery Asked(const Machine& machine, const Record& record) {
  DiscoverOptions options;
  options.doubt = true;
  options.figures = false;
  return Discover(machine, record, nullptr, options);
}

std::vector<std::string> NamesOf(const Discovery& answer) {
  std::vector<std::string> names;
  for (const FoundCause& one : answer.causes) {
    names.push_back(one.cause.name() + "@" + one.cause.site);
  }
  for (const CalibratedNumber& one : answer.calibration) names.push_back(one.name);
  return names;
}

double TwoSines(double t) { return 0.4 * std::sin(2.1 * t) + 0.3 * std::sin(7.7 * t); }

constexpr char kValve[] =
    R"(<option timestep="0.001" gravity="0 0 0"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.4" stiffness="3"/>
       <inertial pos="0 0 -0.15" mass="1.2" diaginertia="0.01 0.01 0.001"/></body></worldbody>
       <actuator><general name="u" joint="j" dyntype="filter" dynprm="0.05" gainprm="6"/>
       </actuator><sensor><jointpos name="y" joint="j"/></sensor>)";

TEST(DiscoverAnyMachine, FindsFrictionBehindAValveThatLags) {
  const Machine valve = MachineOf(kValve, "element = \"y\"\nunit = \"rad\"");
  const Machine rubs = valve.With({{}, {ParseEffect("coulomb_friction@j:force=0.15")}});
  const Discovery answer = Asked(valve, Measure(rubs, TwoSines, 1e-5));
  ASSERT_THAT(NamesOf(answer), ElementsAre("coulomb_friction@j"));
  EXPECT_NEAR(answer.causes[0].parameters[0].value, 0.15, 0.003);
}

// As most simulations have it, in their own steps: where it stands the joint gives way.
TEST(DiscoverAnyMachine, FindsFrictionAsASimulationHasIt) {
  const Machine valve = MachineOf(kValve, "element = \"y\"\nunit = \"rad\"");
  const Machine rubs = valve.With({{}, {ParseEffect("yielding_friction@j:force=0.3")}});
  const Discovery answer = Asked(valve, Measure(rubs, TwoSines, 1e-5, 2));
  ASSERT_THAT(NamesOf(answer), ElementsAre("yielding_friction@j"));
  EXPECT_NEAR(answer.causes[0].parameters[0].value, 0.3, 0.003);
}

// Behind the latent forces of a machine without its friction nobody sees that the joint springs
// a milliradian before it slides.
TEST(DiscoverAnyMachine, FindsFrictionThatSpringsBeforeItSlides) {
  const Machine valve = MachineOf(kValve, "element = \"y\"\nunit = \"rad\"");
  const Machine rubs = valve.With(
      {{}, {ParseEffect("presliding_hysteresis@j:force=0.3,stiffness=300")}});
  const Discovery answer = Asked(valve, Measure(rubs, TwoSines, 1e-5));
  ASSERT_THAT(NamesOf(answer), ElementsAre("presliding_hysteresis@j"));
  EXPECT_NEAR(answer.causes[0].parameters[0].value, 0.3, 0.003);
  EXPECT_NEAR(answer.causes[0].parameters[1].value, 300.0, 30.0);
  // Where it slides, it is dry by as much as its law says.
  ASSERT_EQ(answer.resistances.size(), 1u);
  const FoundResistance& curve = answer.resistances[0];
  EXPECT_EQ(curve.site, "j");
  EXPECT_NEAR(curve.dry.value, answer.causes[0].parameters[0].value, 1e-9);
  EXPECT_NEAR(curve.viscous.value, 0.0, 1e-9);
  EXPECT_NEAR(curve.force[curve.force.size() - 1], 0.3, 0.006);
}

// Two laws are one curve: what is dry of both, and what is viscous.
TEST(DiscoverAnyMachine, SaysWhatResistsAJointAsOneCurve) {
  const Machine valve = MachineOf(kValve, "element = \"y\"\nunit = \"rad\"");
  const Machine rubs =
      valve.With({{},
                  {ParseEffect("coulomb_friction@j:force=0.2"),
                   ParseEffect("viscous_friction@j:coefficient=0.1")}});
  const Discovery answer = Asked(valve, Measure(rubs, TwoSines, 1e-5));
  ASSERT_EQ(answer.resistances.size(), 1u);
  const FoundResistance& curve = answer.resistances[0];
  EXPECT_EQ(curve.members.size(), 2u);
  EXPECT_NEAR(curve.dry.value, 0.2, 0.01);
  EXPECT_NEAR(curve.viscous.value, 0.1, 0.01);
  EXPECT_LE(curve.dry.low, curve.dry.value);
  EXPECT_LE(curve.dry.value, curve.dry.high);
  const Eigen::Index last = curve.speeds.size() - 1;
  EXPECT_NEAR(curve.force[last], 0.2 + 0.1 * curve.speeds[last], 0.01);
}

// Its encoder is at its motor: far below its resonance the carriage follows, and what is between
// gives by the motor's force.
TEST(DiscoverAnyDrive, FindsWhatATransmissionGives) {
  const Machine rigid = MachineOf(
      R"(<option timestep="0.001" gravity="0 0 0"/><worldbody><body>
         <joint name="j" type="slide" axis="1 0 0" damping="8"/>
         <inertial pos="0 0 0" mass="4" diaginertia="1 1 1"/></body></worldbody>
         <actuator><motor name="u" joint="j" gear="30"/></actuator>
         <sensor><jointpos name="y" joint="j"/></sensor>)",
      "element = \"y\"\nunit = \"m\"");
  const Machine belt =
      rigid.With({{}, {ParseEffect("transmission_windup@y:compliance=1e-5")}});
  const auto relay = [](double t) { return std::fmod(t, 0.5) < 0.25 ? 0.6 : -0.6; };
  const Discovery answer = Asked(rigid, Measure(belt, relay, 2e-5));
  ASSERT_THAT(NamesOf(answer), ElementsAre("transmission_windup@y"));
  EXPECT_NEAR(answer.causes[0].parameters[0].value, 1e-5, 2e-7);
}

constexpr char kHovers[] =
    R"(<option timestep="0.001" gravity="0 0 0"/><worldbody><body name="craft">
       <freejoint name="free"/>
       <inertial pos="0 0 0" mass="1.3" diaginertia="0.04 0.03 0.06"/><site name="s"/></body>
       </worldbody><actuator><motor name="u" site="s" gear="0 0 5 0 0 0"/></actuator>
       <sensor><framepos name="y" objtype="site" objname="s"/></sensor>)";

TEST(DiscoverAnyDrive, FindsAWeakMotorOfWhatFlies) {
  const Machine craft =
      MachineOf(kHovers, "element = \"y\"\ncomponent = 2\nunit = \"m\"");
  const ModelParameter gear = FindModelParameter(craft.plant(), "gear@u");
  const Discovery answer =
      Asked(craft, Measure(craft.WithNumbers({{gear, 0.9}}), TwoSines, 1e-5));
  ASSERT_THAT(NamesOf(answer), ElementsAre(::testing::_));
  // A body that is heavier moves the same.
  const CalibratedNumber& number = answer.calibration.at(0);
  EXPECT_NEAR(number.name == "gear@u" ? number.factor : 1.0 / number.factor, 0.9,
              0.005);
}

constexpr char kMounted[] =
    R"(<option timestep="0.001" gravity="0 0 0"/><worldbody><body>
       <joint name="mount" type="slide" axis="1 0 0" stiffness="2e4" damping="60"/>
       <inertial pos="0 0 0" mass="6" diaginertia="1 1 1"/><body>
       <joint name="j" type="slide" axis="1 0 0" damping="4" stiffness="300"/>
       <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></body></worldbody>
       <actuator><motor name="u" joint="j" gear="30"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)";

// Nothing drives it and nothing measures it.
TEST(DiscoverAnyDrive, FindsASoftMountThatNoSensorSees) {
  const Machine stiff = MachineOf(kMounted, "element = \"y\"\nunit = \"m\"");
  const ModelParameter spring = FindModelParameter(stiff.plant(), "stiffness@mount");
  const Record record = Measure(stiff.WithNumbers({{spring, 0.8}}), TwoSines, 1e-6);
  const Discovery answer = Asked(stiff, record);
  ASSERT_THAT(NamesOf(answer), ::testing::Contains("stiffness@mount"));
  EXPECT_NEAR(answer.calibration.at(0).factor, 0.8, 0.01);
}

constexpr char kRigid[] =
    R"(<option timestep="0.001" gravity="0 0 0"/><worldbody><body>
       <joint name="j" axis="0 0 1" damping="0.05" armature="0.01"/>
       <inertial pos="0.1 0 0" mass="0.6" diaginertia="1e-3 3e-3 3e-3"/></body></worldbody>
       <actuator><motor name="u" joint="j"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)";

// Half of the inertia is behind a spring.
TEST(DiscoverAnyDrive, FindsTheSecondMassOfADrive) {
  const Machine rigid = MachineOf(kRigid, "element = \"y\"\nunit = \"rad\"");
  const Machine drive = rigid.With(
      {{},
       {ParseEffect("added_mass@j:mass=-0.009"),
        ParseEffect("flexible_mode@j:mass=0.009,frequency=13,damping_ratio=0.02")}});
  const auto sines = [](double t) {
    double sum = 0.0;
    for (const double hertz : {0.7, 2.3, 5.1, 9.0, 12.2, 14.3, 21.0}) {
      sum += 0.3 * std::sin(2.0 * std::numbers::pi * hertz * t);
    }
    return sum;
  };
  const Discovery answer = Asked(rigid, Measure(drive, sines, 1e-5));
  EXPECT_THAT(NamesOf(answer),
              ::testing::UnorderedElementsAre("added_mass@j", "flexible_mode@j"));
  for (const FoundCause& one : answer.causes) {
    if (one.cause.name() != "flexible_mode") continue;
    EXPECT_NEAR(one.parameters[0].value, 0.009, 2e-4);
    EXPECT_NEAR(one.parameters[1].value, 13.0, 0.1);
  }
}

}  // namespace
}  // namespace mjdiag
