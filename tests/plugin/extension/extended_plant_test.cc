#include "mjdiag/plugin/extension/extended_plant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/changes.h"
#include "support/every_effect.h"
#include "support/kept_folder.h"
#include "support/message_of.h"
#include "support/numbered_plant.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path Folder(const std::string& machine) {
  return std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf" / machine;
}

Record ShortRun(const Machine& machine) {
  const mjdiag::Setup& setup = machine.setup();
  Trajectory trajectory = setup.trajectories.Find(setup.trajectories.fallback);
  // The default motion of EMPS begins at 0.2 s, that of AB383 at 0.01 s.
  trajectory.duration = setup.control.axes.size() > 1 ? 0.1 : 0.5;
  RunOptions options;
  options.noise_scale = 0.0;
  options.log_joints = true;
  return Simulate(machine, FollowTrajectory(setup, trajectory), options);
}

double LargestDifference(const Record& a, const Record& b) {
  double largest = 0.0;
  for (const Channel& channel : a.channels()) {
    const double scale = channel.samples.lpNorm<Eigen::Infinity>();
    const double difference =
        (channel.samples - b.At(channel.name).samples).lpNorm<Eigen::Infinity>();
    if (difference > 0.0) largest = std::max(largest, difference / scale);
  }
  return largest;
}

/// A nominal machine and, in a folder of its own, the same one extended.
class Extension {
 public:
  explicit Extension(const std::filesystem::path& folder,
                     const std::vector<std::string>& overrides = {})
      : nominal_(folder), machine_(ReadSetup(folder, overrides)) {}

  void Write(const Changes& causes) const {
    temporary_.Write("plant.xml", ExtendMjcf(setup().plant, machine_.plant(), causes,
                                             temporary_.path()));
    temporary_.Write("setup.toml", ExtendSetup(nominal_ / "setup.toml", setup(),
                                               causes.effects, temporary_.path()));
    test::KeepFolder(temporary_.path());
  }

  /// Largest difference between the nominal machine with the causes put in and
  /// the extended one, relative to the largest value of the channel.
  double Difference(const Changes& causes) const {
    Write(causes);
    return LargestDifference(ShortRun(machine_.With(causes)),
                             ShortRun(Machine(ReadSetup(temporary_.path()))));
  }

  /// How far the causes move the machine; 0 would make Difference worthless.
  double Influence(const Changes& causes) const {
    return LargestDifference(ShortRun(machine_.With(causes)), ShortRun(machine_));
  }

  std::string Mjcf() const { return ReadTextFile(temporary_ / "plant.xml"); }
  std::string SetupText() const { return ReadTextFile(temporary_ / "setup.toml"); }
  const test::TemporaryFolder& folder() const { return temporary_; }
  const Machine& machine() const { return machine_; }
  const Setup& setup() const { return machine_.setup(); }

 private:
  std::filesystem::path nominal_;
  Machine machine_;
  test::TemporaryFolder temporary_;
};

/// Without a trace of the machine, which a failed run of a whole list would bury.
void ExpectSameMotion(const Extension& extension, const Changes& causes,
                      const std::string& what) {
  EXPECT_LE(extension.Difference(causes), 1e-9) << what;
  EXPECT_GT(extension.Influence(causes), 1e-7) << what;
}

TEST(ExtendedPlant, MovesAsAb383WithEveryEffectByItself) {
  const Extension extension(Folder("ab383"));
  for (const std::string& effect : test::EveryEffectOfAb383()) {
    ExpectSameMotion(extension, test::With({effect}), effect);
  }
}

TEST(ExtendedPlant, MovesAsEmpsWithEveryEffectByItself) {
  const Extension extension(Folder("emps"));
  for (const std::string& effect : test::EveryEffectOfEmps()) {
    ExpectSameMotion(extension, test::With({effect}), effect);
  }
}

TEST(ExtendedPlant, MovesAsTheMachineWithEveryFault) {
  const Changes ab383 = test::With(
      {}, {{"zeta_x", 1.37}, {"beta_y", 0.91}, {"eta_x", 0.93}, {"eta_z", 1.01}});
  ExpectSameMotion(Extension(Folder("ab383")), ab383, "AB383");
  ExpectSameMotion(Extension(Folder("emps")),
                   test::With({}, {{"zeta", 1.3}, {"eta", 0.9}}), "EMPS");
}

TEST(ExtendedPlant, MovesAsTheMachineWithOtherNumbers) {
  const Extension extension(Folder("ab383"));
  Changes changes;
  for (const auto& [name, factor] :
       std::map<std::string, double>{{"mass@y_stage", 0.99},
                                     {"inertia@arm", 1.04},
                                     {"stiffness@u3", 1.1},
                                     {"damping@X", 0.7},
                                     {"friction@Y", 1.3},
                                     {"gear@z_motor", 0.95}}) {
    changes.numbers.emplace_back(FindModelParameter(extension.machine().plant(), name),
                                 factor);
  }
  ExpectSameMotion(extension, changes, "all kinds");
  for (const auto& number : changes.numbers) {
    EXPECT_GT(extension.Influence({{}, {}, {number}}), 1e-7)
        << ModelParameterName(extension.machine().plant(), number.first);
  }
}

TEST(ExtendedPlant, HasTheRotorAndTheWindingThatWereFound) {
  const Machine servo(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"));
  const std::filesystem::path plant = servo.setup().plant;
  NumberFactors numbers;
  for (const std::string name : {"armature@shaft", "gain@motor"}) {
    numbers.emplace_back(FindModelParameter(servo.plant(), name), 1.125);
  }
  const test::TemporaryFolder folder;
  const std::string text =
      ExtendMjcf(plant, servo.plant(), {{}, {}, numbers}, folder.path());
  const ModelPtr read = LoadModel(folder.Write("plant.xml", text));
  test::KeepFolder(folder.path());
  EXPECT_DOUBLE_EQ(read->dof_armature[0], 1.125 * servo.plant().dof_armature[0]);
  EXPECT_DOUBLE_EQ(read->actuator_gainprm[0],
                   1.125 * servo.plant().actuator_gainprm[0]);
  EXPECT_DOUBLE_EQ(read->actuator_biasprm[2],
                   1.125 * servo.plant().actuator_biasprm[2]);
  EXPECT_EQ(read->actuator_gear[0], servo.plant().actuator_gear[0]);
}

/// What is read of the text of a plant with those numbers.
ModelPtr ReadWith(const std::string& mjcf, const NumberFactors& factors) {
  const test::TemporaryFolder folder;
  const std::filesystem::path plant = folder.Write("nominal.xml", mjcf);
  const ModelPtr nominal = LoadModel(plant);
  const std::filesystem::path extended = folder.Write(
      "plant.xml",
      ExtendMjcf(plant, *nominal, {{}, {}, factors}, folder.path() / "extended"));
  test::KeepFolder(folder.path());
  return LoadModel(extended);
}

TEST(ExtendedPlant, HasEveryNumberThatIsAnother) {
  // Angles in degrees, as most files have them.
  const std::string mjcf =
      "<mujoco><option timestep=\"0.001\"/>" + test::NumberedMjcf() + "</mujoco>";
  const ModelPtr nominal = test::PlantOf(mjcf);
  for (const auto& [name, value] : test::kNumberedValues) {
    const ModelParameter number = FindModelParameter(*nominal, name);
    const ModelPtr expected = CopyModel(*nominal);
    ScaleNumbers(*expected, {{number, 1.1}});
    const ModelPtr read = ReadWith(mjcf, {{number, 1.1}});
    EXPECT_NEAR(ValueOf(*read, number), ValueOf(*expected, number),
                1e-14 * std::abs(ValueOf(*expected, number)))
        << name;
    EXPECT_NE(ValueOf(*read, number), ValueOf(*nominal, number)) << name;
  }
}

// <position> has one number for both.
TEST(ExtendedPlant, SaysWhatATagCannotSay) {
  const std::string mjcf = R"(<mujoco><worldbody><body><joint name="j" type="slide"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
    <actuator><velocity name="drive" joint="j" kv="3"/></actuator></mujoco>)";
  const ModelPtr nominal = test::PlantOf(mjcf);
  const ModelPtr read =
      ReadWith(mjcf, {{FindModelParameter(*nominal, "gain@drive"), 2.0}});
  EXPECT_EQ(read->actuator_gainprm[0], 6.0);
  EXPECT_EQ(read->actuator_biasprm[2], -6.0);
  EXPECT_THAT(test::MessageOf<InputError>([&] {
                ReadWith(mjcf, {{FindModelParameter(*nominal, "kv@drive"), 2.0}});
              }),
              testing::AllOf(HasSubstr("<velocity>"), HasSubstr("<general>")));
}

TEST(ExtendedPlant, HoldsSeveralCausesAtOneSite) {
  const Changes causes = test::With(
      {"coulomb_friction@load:force=11.1", "coulomb_friction@load:force=7.3",
       "stribeck_friction@load:coulomb=1.1,breakaway=3.7,velocity=0.0013",
       "viscous_friction@load:coefficient=3.1", "force_offset@load:force=1.3",
       "force_ripple@load:amplitude=1.7,period=0.0241,phase=0.3",
       "force_ripple@load:amplitude=0.3,period=0.0113", "added_mass@load:mass=1.3",
       "added_mass@load:mass=0.7", "motor_constant@drive:factor=0.97"},
      {{"zeta", 1.2}});
  const Extension extension(Folder("emps"));
  ExpectSameMotion(extension, causes, "several");
  EXPECT_THAT(extension.Mjcf(),
              HasSubstr(R"(<numeric name="effect.force_ripple.load" size="6" )"
                        R"(data="1.7 0.0241 0.3 0.3 0.0113 0"/>)"));
}

TEST(ExtendedPlant, IsExtendedOnceMore) {
  const Changes first =
      test::With({"stribeck_friction@load:coulomb=13.1,breakaway=7.7,velocity=0.0013",
                  "force_offset@load:force=1.3", "linear_stiffness@load:stiffness=100"},
                 {{"zeta", 1.2}});
  const Changes second =
      test::With({"stribeck_friction@load:coulomb=1.1,breakaway=0.7,velocity=0.03",
                  "force_offset@load:force=0.4", "coulomb_friction@load:force=2.2"},
                 {{"zeta", 1.1}});
  const Extension once(Folder("emps"));
  once.Write(first);
  const Extension twice(once.folder().path());
  ExpectSameMotion(twice, second, "the second time");
  EXPECT_THAT(twice.Mjcf(), HasSubstr(R"(size="2" data="1.3 0.4")"));
  EXPECT_EQ(twice.SetupText(), once.SetupText());

  Changes both = first;
  both.effects.insert(both.effects.end(), second.effects.begin(), second.effects.end());
  both.faults = {{"zeta", 1.2 * 1.1}};
  EXPECT_LE(LargestDifference(ShortRun(once.machine().With(both)),
                              ShortRun(twice.machine().With(second))),
            1e-9);
}

// A native effect that the nominal file carries as a numeric is in the attribute
// afterwards, and must not act twice.
TEST(ExtendedPlant, TakesNativeEffectsOfTheNominalPlantIntoItsAttributes) {
  const test::TemporaryFolder folder;
  std::string mjcf = ReadTextFile(Folder("emps") / "plant.xml");
  mjcf.insert(mjcf.find("  </custom>"),
              "    <numeric name=\"effect.coulomb_friction.load\" data=\"17 0.5\"/>\n");
  folder.Write("plant.xml", mjcf);
  folder.Write("setup.toml", ReadTextFile(Folder("emps") / "setup.toml"));
  const Extension extension(folder.path());
  ExpectSameMotion(extension, test::With({"viscous_friction@load:coefficient=31"}),
                   "carried");
  EXPECT_THAT(extension.Mjcf(), HasSubstr(R"(frictionloss="17.5")"));
  EXPECT_THAT(extension.Mjcf(), Not(HasSubstr("effect.coulomb_friction")));
}

TEST(ExtendedPlant, KeepsStaticFrictionOffWhereTheSetupSwitchesItOff) {
  const Extension extension(Folder("ab383"), {"physics.static_friction=false"});
  ExpectSameMotion(extension, test::With({"coulomb_friction@Y:force=1.7"}),
                   "friction of Y");
}

TEST(ExtendedPlant, IsLoadedByStockMujoco) {
  for (const char* machine : {"ab383", "emps"}) {
    const Extension extension(Folder(machine));
    extension.Write(test::With(machine == std::string("ab383")
                                   ? test::EveryEffectOfAb383()
                                   : test::EveryEffectOfEmps()));
    char error[512] = "";
    const ModelPtr model(mj_loadXML((extension.folder() / "plant.xml").c_str(), nullptr,
                                    error, sizeof(error)));
    EXPECT_NE(model, nullptr) << error;
  }
}

TEST(ExtendedPlant, DiffersFromTheNominalOneOnlyWhereSomethingWasFound) {
  const Extension extension(Folder("ab383"));
  extension.Write({});
  EXPECT_EQ(extension.Mjcf(), ReadTextFile(Folder("ab383") / "plant.xml"));

  extension.Write(test::With({"viscous_friction@X:coefficient=7"}));
  std::string expected = ReadTextFile(Folder("ab383") / "plant.xml");
  const std::string before = R"(damping="115.97571401384852")";
  expected.replace(expected.find(before), before.size(),
                   R"(damping="122.97571401384852")");
  EXPECT_EQ(extension.Mjcf(), expected);
}

TEST(ExtendedPlant, HasEncoderNoiseInTheSetup) {
  const Extension ab383(Folder("ab383"));
  ab383.Write(test::With({"encoder_noise@x_encoder:sd=3e-8"}));
  // Once, not in both files.
  EXPECT_THAT(ab383.Mjcf(), Not(HasSubstr("encoder_noise")));
  // 20 nm of its own.
  const mjdiag::Setup noisy = ReadSetup(ab383.folder().path());
  EXPECT_NEAR(noisy.channels.Sensor("x").noise_sd, std::hypot(2e-8, 3e-8), 1e-20);
  EXPECT_EQ(noisy.channels.Sensor("y").noise_sd,
            ab383.setup().channels.Sensor("y").noise_sd);

  const Extension emps(Folder("emps"));
  emps.Write(test::With({"encoder_noise@load_encoder:sd=3e-6"}));
  EXPECT_EQ(ReadSetup(emps.folder().path()).channels.Sensor("q").noise_sd, 3e-6);
  EXPECT_THAT(emps.SetupText(), HasSubstr("element = \"load_encoder\"\n"
                                          "noise_sd = 3e-06\nunit = \"m\"\n"));
}

TEST(ExtendedPlant, HasASetupThatIsKeptLineByLine) {
  const Extension extension(Folder("ab383"));
  extension.Write({});
  std::string expected = ReadTextFile(Folder("ab383") / "setup.toml");
  const auto change = [&](const std::string& from, const std::string& to) {
    expected.replace(expected.find(from), from.size(), to);
  };
  change("name = \"AB383 wire bonder\"", "name = \"AB383 wire bonder (extended)\"");
  change("analytic = \"analytic.toml\"\npublished = \"published_row.toml\"\n", "");
  EXPECT_EQ(extension.SetupText(), expected);
}

TEST(ExtendedPlant, RefusesToReplaceTheNominalOne) {
  const Extension extension(Folder("emps"));
  const auto mjcf = [&] {
    ExtendMjcf(extension.setup().plant, extension.machine().plant(), {},
               Folder("emps"));
  };
  EXPECT_THAT(test::MessageOf<InputError>(mjcf), HasSubstr("holds the nominal plant"));
  const auto setup = [&] {
    ExtendSetup(Folder("emps") / "setup.toml", extension.setup(), {}, Folder("emps"));
  };
  EXPECT_THAT(test::MessageOf<InputError>(setup), HasSubstr("holds the nominal setup"));
}

}  // namespace
}  // namespace mjdiag
