// Records of one machine under different loads.

#include "mjdiag/discovery/measurements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "discovery/checks/checked_machine.h"
#include "mjdiag/discovery/discovery.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;

std::string Stage(double mass, const std::string& joint = "stage") {
  return R"(<mujoco model="stage"><option timestep="0.0005" integrator="Euler"/>
  <worldbody><body name="stage"><joint name=")" +
         joint + R"(" type="slide" axis="1 0 0" damping="2" stiffness="500"/>
    <inertial pos="0 0 0" mass=")" +
         std::to_string(mass) + R"(" diaginertia="1e-4 1e-4 1e-4"/></body></worldbody>
  <actuator><motor name="coil" joint=")" +
         joint + R"("/></actuator><sensor><jointpos name="encoder" joint=")" + joint +
         R"("/></sensor></mujoco>)";
}

class LoadedRecords : public testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("plant.xml", Stage(1.0));
    folder_.Write("loaded.xml", Stage(1.7));
    folder_.Write("other.xml", Stage(1.7, "slide"));
    folder_.Write("setup.toml", R"(schema = "mjdiag.setup/1"
name = "stage"
plant = "plant.xml"
[rates]
control = 1000.0
substeps = 2
[sensors.x]
element = "encoder"
unit = "m"
noise_sd = 1e-6
[actuators.f]
element = "coil"
unit = "N"
)");
    Measure("bare.csv", "plant.xml");
    Measure("loaded.csv", "loaded.xml");
  }

  Machine Load(const std::string& plant) const {
    return Machine(ReadSetup(folder_.path().string(), {"plant=\"" + plant + "\""}));
  }

  /// With dry friction of 0.2 N, which no plant has.
  void Measure(const std::string& file, const std::string& plant) const {
    const Machine machine =
        Load(plant).With(test::With({"coulomb_friction@stage:force=0.2"}));
    const Excitation excitation = test::InputOf(machine, 4000, [](double t) {
      return 4.0 * std::sin(2.0 * t * (3.0 + 4.0 * t)) + 1.5 * std::sin(7.0 * t);
    });
    WriteRecord(folder_ / file, Simulate(machine, excitation, {}), RecordFormat::kCsv);
  }

  Measurements Read(const std::string& plant) const {
    return ReadMeasurements(
        Load("plant.xml"), folder_.path(), {},
        {{folder_ / "bare.csv"}, {folder_ / "loaded.csv", true, {}, plant}});
  }

  /// The second with a number of its own.
  Measurements ReadWith(const std::string& number, double value) const {
    return ReadMeasurements(
        Load("plant.xml"), folder_.path(), {},
        {{folder_ / "bare.csv"},
         {folder_ / "loaded.csv", true, {}, "", {{number, value}}}});
  }

  const test::TemporaryFolder folder_;
};

TEST_F(LoadedRecords, MayDifferInNumbersAlone) {
  const Measurements measurements = ReadWith("mass@stage", 1.7);
  EXPECT_EQ(measurements.fit[0].machine.plant().body_mass[1], 1.0);
  EXPECT_NEAR(measurements.fit[1].machine.plant().body_mass[1], 1.7, 1e-15);
  ASSERT_NE(RunOf(measurements.fit).records[1].machine, nullptr);
  // What is found of the machine holds for the load as well.
  const Machine& loaded = measurements.fit[1].machine;
  const Machine heavier =
      loaded.With({{}, {}, {{FindModelParameter(loaded.plant(), "mass@stage"), 1.1}}});
  EXPECT_NEAR(heavier.plant().body_mass[1], 1.87, 1e-15);
  EXPECT_THAT(test::MessageOf<InputError>([&] { ReadWith("mass@table", 2.0); }),
              testing::AllOf(HasSubstr("numbers of loaded.csv"), HasSubstr("table")));
  EXPECT_THAT(test::MessageOf<InputError>([&] { ReadWith("friction@stage", 2.0); }),
              HasSubstr("is 0 in the plant"));
}

TEST_F(LoadedRecords, HaveTheirOwnPlants) {
  const Measurements measurements = Read("loaded.xml");
  EXPECT_EQ(measurements.fit[0].machine.plant().body_mass[1], 1.0);
  EXPECT_EQ(measurements.fit[1].machine.plant().body_mass[1], 1.7);
  EXPECT_EQ(RunOf(measurements.fit).records[0].machine, nullptr);
  ASSERT_NE(RunOf(measurements.fit).records[1].machine, nullptr);
}

TEST_F(LoadedRecords, ShowOneCauseInAllOfThem) {
  DiscoverOptions options;
  options.doubt = false;
  options.figures = false;
  const Discovery found = Discover(Load("plant.xml"), Read("loaded.xml"), options);
  ASSERT_EQ(found.causes.size(), 1u);
  EXPECT_EQ(found.causes[0].cause.site, "stage");
  EXPECT_THAT(found.causes[0].cause.effect->name(), HasSubstr("friction"));
}

TEST_F(LoadedRecords, OfAnotherMachineAreRefused) {
  EXPECT_EQ(test::MessageOf<InputError>([&] { Read("other.xml"); }),
            "other.xml: has other joints than 'stage'; expected the joints, actuators "
            "and sensors of the setup's plant, in the same order");
}

}  // namespace
}  // namespace mjdiag
