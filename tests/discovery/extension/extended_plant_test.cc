#include "mjdiag/discovery/extension/extended_plant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path Folder(const std::string& machine) {
  return std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf" / machine;
}

Record ShortRun(const Setup& setup, const mjModel& plant,
                const RunOptions& causes = {}) {
  Trajectory trajectory = setup.trajectories.Find(setup.trajectories.fallback);
  // The default motion of EMPS begins at 0.2 s, that of AB383 at 0.01 s.
  trajectory.duration = setup.control.axes.size() > 1 ? 0.1 : 0.5;
  RunOptions options = causes;
  options.noise_scale = 0.0;
  options.log_joints = true;
  return Simulate(setup, plant, FollowTrajectory(setup, trajectory), options);
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
      : nominal_(folder),
        setup_(ReadSetup(folder, overrides)),
        plant_(LoadPlant(setup_)) {}

  void Write(const RunOptions& causes) const {
    temporary_.Write("plant.xml", ExtendMjcf(setup_.plant, *plant_, causes.faults,
                                             causes.effects, temporary_.path()));
    temporary_.Write("setup.toml", ExtendSetup(nominal_ / "setup.toml", setup_,
                                               causes.effects, temporary_.path()));
  }

  /// Largest difference between the nominal machine with the causes in its options and
  /// the extended one, relative to the largest value of the channel.
  double Difference(const RunOptions& causes) const {
    Write(causes);
    const mjdiag::Setup extended = ReadSetup(temporary_.path());
    const ModelPtr plant = LoadPlant(extended);
    return LargestDifference(ShortRun(setup_, *plant_, causes),
                             ShortRun(extended, *plant));
  }

  /// How far the causes move the machine; 0 would make Difference worthless.
  double Influence(const RunOptions& causes) const {
    return LargestDifference(ShortRun(setup_, *plant_, causes),
                             ShortRun(setup_, *plant_));
  }

  std::string Mjcf() const { return ReadTextFile(temporary_ / "plant.xml"); }
  std::string SetupText() const { return ReadTextFile(temporary_ / "setup.toml"); }
  const test::TemporaryFolder& folder() const { return temporary_; }
  const Setup& setup() const { return setup_; }
  const mjModel& plant() const { return *plant_; }

 private:
  std::filesystem::path nominal_;
  mjdiag::Setup setup_;
  ModelPtr plant_;
  test::TemporaryFolder temporary_;
};

RunOptions With(const std::vector<std::string>& effects,
                const std::vector<Fault>& faults = {}) {
  RunOptions options;
  options.faults = faults;
  for (const std::string& effect : effects) {
    options.effects.push_back(ParseEffect(effect));
  }
  return options;
}

/// Every effect of the catalogue at a site of each machine, large enough to move it.
const std::vector<std::string>& EveryEffectOfAb383() {
  static const std::vector<std::string> effects{
      "coulomb_friction@X:force=1.3",
      "stribeck_friction@Y:coulomb=0.7,breakaway=0.9,velocity=0.013",
      "viscous_friction@X:coefficient=7.1",
      "asymmetric_viscous_friction@Y:positive=3.3,negative=-1.1",
      "quadratic_drag@X:coefficient=11.7",
      "presliding_hysteresis@Y:force=1.1,stiffness=230000",
      "hysteretic_stiffness@X:stiffness=170,loss=0.3,length=0.0011",
      "force_offset@Z:force=0.0031",
      "force_ripple@Y:amplitude=0.7,period=0.0241,phase=0.3",
      "motor_constant@x_motor:factor=0.971",
      "position_dependent_motor_constant@y_motor:slope=1.7,curvature=-31.3",
      "force_saturation@x_motor:limit=207.3",
      "input_delay@x_motor:delay=1.37e-4",
      "amplifier_lag@z_motor:time_constant=7.3e-5",
      "linear_stiffness@Y:stiffness=313.7",
      "linear_stiffness@Z:stiffness=-0.217",
      "cubic_stiffness@X:coefficient=1.1e7",
      "structural_stiffness@r2:factor=0.83",
      "added_mass@Y:mass=0.0371",
      "added_mass@Z:mass=3.1e-6",
      "flexible_mode@X:mass=0.13,frequency=171.3,damping_ratio=0.017",
      "backlash@u3:gap=1.3e-8",
      "end_stop@X:position=0.0017,stiffness=1.3e5",
      "floor_vibration@u1:amplitude=9.1,frequency=33.3,phase=0.7",
      "encoder_scale@x_encoder:factor=1.00013",
      "encoder_periodic_error@y_encoder:amplitude=3.1e-8,period=2e-5",
      "encoder_drift@z_encoder:rate=1.7e-5"};
  return effects;
}

const std::vector<std::string>& EveryEffectOfEmps() {
  static const std::vector<std::string> effects{
      "coulomb_friction@load:force=20.3",
      "stribeck_friction@load:coulomb=13.1,breakaway=7.7,velocity=0.0013",
      "viscous_friction@load:coefficient=-17.3",
      "asymmetric_viscous_friction@load:positive=13.3,negative=-7.1",
      "quadratic_drag@load:coefficient=31.7",
      "presliding_hysteresis@load:force=7.1,stiffness=230000",
      "hysteretic_stiffness@load:stiffness=1700,loss=0.3,length=0.0011",
      "force_offset@load:force=-3.1648",
      "force_ripple@load:amplitude=1.7,period=0.0241,phase=0.3",
      "motor_constant@drive:factor=0.971",
      "position_dependent_motor_constant@drive:slope=0.37,curvature=-1.3",
      "force_saturation@drive:limit=1.3",
      "input_delay@drive:delay=1.37e-3",
      "amplifier_lag@drive:time_constant=7.3e-4",
      "linear_stiffness@load:stiffness=313.7",
      "cubic_stiffness@load:coefficient=1.1e4",
      "added_mass@load:mass=-1.71",
      "flexible_mode@load:mass=3.1,frequency=31.3,damping_ratio=0.017",
      "end_stop@load:position=0.0017,stiffness=1.3e4",
      "floor_vibration@load:amplitude=3.1,frequency=33.3,phase=0.7",
      "encoder_scale@load_encoder:factor=1.00013",
      "encoder_periodic_error@load_encoder:amplitude=3.1e-6,period=2e-3",
      "encoder_drift@load_encoder:rate=1.7e-5"};
  return effects;
}

/// Without a trace of the machine, which a failed run of a whole list would bury.
void ExpectSameMotion(const Extension& extension, const RunOptions& causes,
                      const std::string& what) {
  EXPECT_LE(extension.Difference(causes), 1e-9) << what;
  EXPECT_GT(extension.Influence(causes), 1e-7) << what;
}

TEST(ExtendedPlant, MovesAsAb383WithEveryEffectByItself) {
  const Extension extension(Folder("ab383"));
  for (const std::string& effect : EveryEffectOfAb383()) {
    ExpectSameMotion(extension, With({effect}), effect);
  }
}

TEST(ExtendedPlant, MovesAsEmpsWithEveryEffectByItself) {
  const Extension extension(Folder("emps"));
  for (const std::string& effect : EveryEffectOfEmps()) {
    ExpectSameMotion(extension, With({effect}), effect);
  }
}

TEST(ExtendedPlant, IsTestedWithTheWholeCatalogue) {
  for (const EffectType& type : EffectCatalogue()) {
    // Noise is in the setup, see below.
    if (type.name == "encoder_noise") continue;
    const auto is_tested = [&](const std::vector<std::string>& effects) {
      return std::any_of(effects.begin(), effects.end(), [&](const std::string& text) {
        return text.starts_with(type.name + "@");
      });
    };
    EXPECT_TRUE(is_tested(EveryEffectOfAb383())) << type.name;
    // Nothing in EMPS is held by a spring.
    if (type.site == EffectSite::kHeldJoint) continue;
    EXPECT_TRUE(is_tested(EveryEffectOfEmps())) << type.name;
  }
}

TEST(ExtendedPlant, MovesAsTheMachineWithEveryFaultTurned) {
  const RunOptions ab383 =
      With({}, {{"zeta_x", 1.37}, {"beta_y", 0.91}, {"eta_x", 0.93}, {"eta_z", 1.01}});
  ExpectSameMotion(Extension(Folder("ab383")), ab383, "AB383");
  ExpectSameMotion(Extension(Folder("emps")), With({}, {{"zeta", 1.3}, {"eta", 0.9}}),
                   "EMPS");
}

TEST(ExtendedPlant, HoldsSeveralCausesAtOneSite) {
  const RunOptions causes =
      With({"coulomb_friction@load:force=11.1", "coulomb_friction@load:force=7.3",
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
  const RunOptions first =
      With({"stribeck_friction@load:coulomb=13.1,breakaway=7.7,velocity=0.0013",
            "force_offset@load:force=1.3", "linear_stiffness@load:stiffness=100"},
           {{"zeta", 1.2}});
  const RunOptions second =
      With({"stribeck_friction@load:coulomb=1.1,breakaway=0.7,velocity=0.03",
            "force_offset@load:force=0.4", "coulomb_friction@load:force=2.2"},
           {{"zeta", 1.1}});
  const Extension once(Folder("emps"));
  once.Write(first);
  const Extension twice(once.folder().path());
  ExpectSameMotion(twice, second, "the second time");
  EXPECT_THAT(twice.Mjcf(), HasSubstr(R"(size="2" data="1.3 0.4")"));
  EXPECT_EQ(twice.SetupText(), once.SetupText());

  RunOptions both = first;
  both.effects.insert(both.effects.end(), second.effects.begin(), second.effects.end());
  both.faults = {{"zeta", 1.2 * 1.1}};
  EXPECT_LE(LargestDifference(ShortRun(once.setup(), once.plant(), both),
                              ShortRun(twice.setup(), twice.plant(), second)),
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
  ExpectSameMotion(extension, With({"viscous_friction@load:coefficient=31"}),
                   "carried");
  EXPECT_THAT(extension.Mjcf(), HasSubstr(R"(frictionloss="17.5")"));
  EXPECT_THAT(extension.Mjcf(), Not(HasSubstr("effect.coulomb_friction")));
}

TEST(ExtendedPlant, KeepsStaticFrictionOffWhereTheSetupSwitchesItOff) {
  const Extension extension(Folder("ab383"), {"physics.static_friction=false"});
  ExpectSameMotion(extension, With({"coulomb_friction@Y:force=1.7"}), "friction of Y");
}

TEST(ExtendedPlant, IsLoadedByStockMujoco) {
  for (const char* machine : {"ab383", "emps"}) {
    const Extension extension(Folder(machine));
    extension.Write(With(machine == std::string("ab383") ? EveryEffectOfAb383()
                                                         : EveryEffectOfEmps()));
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

  extension.Write(With({"viscous_friction@X:coefficient=7"}));
  std::string expected = ReadTextFile(Folder("ab383") / "plant.xml");
  const std::string before = R"(damping="115.97571401384852")";
  expected.replace(expected.find(before), before.size(),
                   R"(damping="122.97571401384852")");
  EXPECT_EQ(extension.Mjcf(), expected);
}

TEST(ExtendedPlant, HasEncoderNoiseInTheSetup) {
  const Extension ab383(Folder("ab383"));
  ab383.Write(With({"encoder_noise@x_encoder:sd=3e-8"}));
  // Once, not in both files.
  EXPECT_THAT(ab383.Mjcf(), Not(HasSubstr("encoder_noise")));
  // 20 nm of its own.
  const mjdiag::Setup noisy = ReadSetup(ab383.folder().path());
  EXPECT_NEAR(noisy.channels.Sensor("x").noise_sd, std::hypot(2e-8, 3e-8), 1e-20);
  EXPECT_EQ(noisy.channels.Sensor("y").noise_sd,
            ab383.setup().channels.Sensor("y").noise_sd);

  const Extension emps(Folder("emps"));
  emps.Write(With({"encoder_noise@load_encoder:sd=3e-6"}));
  EXPECT_EQ(ReadSetup(emps.folder().path()).Sensor("q").noise_sd, 3e-6);
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
    ExtendMjcf(extension.setup().plant, extension.plant(), {}, {}, Folder("emps"));
  };
  EXPECT_THAT(test::MessageOf<InputError>(mjcf), HasSubstr("holds the nominal plant"));
  const auto setup = [&] {
    ExtendSetup(Folder("emps") / "setup.toml", extension.setup(), {}, Folder("emps"));
  };
  EXPECT_THAT(test::MessageOf<InputError>(setup), HasSubstr("holds the nominal setup"));
}

}  // namespace
}  // namespace mjdiag
