#include "mjdiag/plugin/machine/machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/bonder.h"
#include "support/changes.h"
#include "support/message_of.h"
#include "support/stage.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double DampingOf(const Machine& machine, const std::string& joint) {
  const mjModel& plant = machine.plant();
  return plant.dof_damping[FindElement(plant, mjOBJ_JOINT, joint)];
}

std::vector<std::string> EffectsIn(const Machine& machine) {
  std::vector<std::string> texts;
  for (const PlacedEffect& effect : machine.effects()) {
    texts.push_back(FormatEffect(effect));
  }
  return texts;
}

TEST(Machine, IsDerivedOnceWhicheverCopyIsAsked) {
  const Machine machine = test::Bonder();
  const Machine copy = machine;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(&copy.plant(), &machine.plant());
  const MechanicalModel* linear = &copy.linear();
  const Eigen::VectorXd* rest = &copy.rest();
  EXPECT_EQ(&machine.linear(), linear);
  EXPECT_EQ(&machine.rest(), rest);
  EXPECT_EQ(linear->M.rows(), machine.plant().nv);
  EXPECT_EQ(rest->size(), machine.plant().nq);
}

TEST(Machine, IsDerivedOnceThoughSeveralThreadsAskAtATime) {
  const Machine machine = test::Bonder();
  std::vector<const MechanicalModel*> seen(4);
  std::vector<std::thread> threads;
  threads.reserve(seen.size());
  for (auto& linear : seen) {
    threads.emplace_back([&linear, machine] { linear = &machine.linear(); });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(seen, testing::Each(&machine.linear()));
}

TEST(Machine, WithNothingIsTheSame) {
  const Machine machine = test::Bonder();
  const Machine same = machine.With({});
  EXPECT_EQ(&same.plant(), &machine.plant());
  EXPECT_EQ(&same.setup(), &machine.setup());
  EXPECT_EQ(&same.linear(), &machine.linear());
}

TEST(Machine, WithChangesLeavesTheNominalOneUnchanged) {
  const Machine nominal = test::Bonder();
  const double damping = DampingOf(nominal, "X");
  const Eigen::MatrixXd before = nominal.linear().D;
  const Machine worn = nominal.With(
      test::With({"viscous_friction@Y:coefficient=7", "force_offset@X:force=1"},
                 {{"zeta_x", 1.5}}));
  EXPECT_EQ(DampingOf(worn, "X"), 1.5 * damping);
  EXPECT_NE(DampingOf(worn, "Y"), DampingOf(nominal, "Y"));
  EXPECT_EQ(DampingOf(nominal, "X"), damping);
  EXPECT_EQ(nominal.changes(), Changes{});
  EXPECT_THAT(nominal.effects(), IsEmpty());
  EXPECT_THAT(EffectsIn(worn), ElementsAre("viscous_friction@Y:coefficient=7",
                                           "force_offset@X:force=1"));
  EXPECT_EQ(worn.changes().faults, (std::vector<Fault>{{"zeta_x", 1.5}}));
  // What is derived is that of the machine that is asked.
  EXPECT_GT((worn.linear().D - before).norm(), 50.0);
  EXPECT_EQ(nominal.linear().D, before);
}

TEST(Machine, ChangesAddUp) {
  const Machine nominal = test::Bonder();
  const Changes first = test::With({"added_mass@X:mass=0.1"}, {{"zeta_x", 1.5}});
  const Changes second =
      test::With({"viscous_friction@X:coefficient=3"}, {{"eta_x", 0.5}});
  const Machine stepwise = nominal.With(first).With(second);
  const Machine direct = nominal.With(
      test::With({"added_mass@X:mass=0.1", "viscous_friction@X:coefficient=3"},
                 {{"zeta_x", 1.5}, {"eta_x", 0.5}}));
  EXPECT_EQ(stepwise.changes(), direct.changes());
  EXPECT_DOUBLE_EQ(DampingOf(stepwise, "X"), DampingOf(direct, "X"));
  EXPECT_DOUBLE_EQ(DampingOf(stepwise, "X"), 1.5 * DampingOf(nominal, "X") + 3.0);
  EXPECT_LT((stepwise.linear().M - direct.linear().M).norm(), 1e-12);
  EXPECT_LT((stepwise.linear().Gamma - direct.linear().Gamma).norm(), 1e-12);
}

TEST(Machine, RefusesChangesThatThePlantDoesNotAllow) {
  const Machine machine = test::Bonder();
  EXPECT_THAT(test::MessageOf<InputError>([&] {
                machine.With({{{"zeta_q", 1.0}}, {}});
              }),
              HasSubstr("zeta_x, zeta_y, beta_x"));
  EXPECT_THAT(test::MessageOf<InputError>(
                  [&] { machine.With(test::With({"added_mass@nobody:mass=1"})); }),
              HasSubstr("nobody"));
}

TEST(Machine, HasTheEncoderNoiseOfItsEffectsBesideItsOwn) {
  const Machine quiet = test::Bonder();
  const double own = quiet.channels().Sensor("x").noise_sd;
  const Machine noisy = quiet.With(test::With({"encoder_noise@x_encoder:sd=3e-8"}));
  EXPECT_DOUBLE_EQ(noisy.channels().Sensor("x").noise_sd, std::hypot(own, 3e-8));
  EXPECT_EQ(noisy.channels().Sensor("y").noise_sd, own);
  EXPECT_EQ(quiet.channels().Sensor("x").noise_sd, own);
  // Measured noise takes the place of the sensor's own.
  const Machine measured = noisy.WithSensorNoise(Eigen::Vector3d(4e-8, 5e-8, 6e-8));
  EXPECT_DOUBLE_EQ(measured.channels().Sensor("x").noise_sd, 5e-8);
  EXPECT_EQ(measured.channels().Sensor("y").noise_sd, 5e-8);
  EXPECT_EQ(measured.channels().Sensor("z").noise_sd, 6e-8);
}

// What the plant itself has of an effect, what reads and what drives is another machine.
TEST(Machine, DiffersInPushesByWhatPushesAtJointsAlone) {
  const Machine bonder = test::Bonder();
  const auto with = [&](const char* effect) {
    return bonder.With(test::With({effect}));
  };
  const Machine stiff = with("cubic_stiffness@X:coefficient=1e6");
  EXPECT_TRUE(bonder.DiffersInPushes(bonder));
  EXPECT_TRUE(bonder.DiffersInPushes(stiff));
  EXPECT_TRUE(stiff.DiffersInPushes(with("cubic_stiffness@X:coefficient=2e6")));
  for (const char* effect :
       {"viscous_friction@X:coefficient=1", "coulomb_friction@X:force=1",
        "added_mass@X:mass=0.1", "encoder_scale@x_encoder:factor=1.001",
        "flexible_mode@X:mass=0.1,frequency=100,damping_ratio=0.01"}) {
    EXPECT_FALSE(bonder.DiffersInPushes(with(effect))) << effect;
  }
  EXPECT_FALSE(bonder.DiffersInPushes(bonder.WithSubsteps(2)));
  const ModelParameter mass = FindModelParameter(bonder.plant(), "mass@x_stage");
  EXPECT_FALSE(bonder.DiffersInPushes(bonder.WithNumbers({{mass, 1.1}})));
}

TEST(Machine, WithAnotherSetupHasTheSamePlantAndChanges) {
  const Machine worn = test::Bonder().With({{{"zeta_x", 1.2}}, {}});
  mjdiag::Setup setup = worn.setup();
  setup.name = "another";
  const Machine other = worn.WithSetup(setup);
  EXPECT_EQ(other.setup().name, "another");
  EXPECT_NE(worn.setup().name, "another");
  EXPECT_EQ(&other.plant(), &worn.plant());
  EXPECT_EQ(other.changes(), worn.changes());
}

TEST(Machine, WithOtherSubstepsIsTheSamePhysics) {
  const test::Stage stage;
  const Machine fine = stage.machine.WithSubsteps(8);
  EXPECT_EQ(fine.rates().substeps, 8);
  EXPECT_DOUBLE_EQ(8.0 * fine.plant().opt.timestep, fine.rates().tick());
  EXPECT_EQ(stage.machine.rates().substeps, 2);
  EXPECT_DOUBLE_EQ(2.0 * stage.machine.plant().opt.timestep,
                   stage.setup().rates.tick());
  EXPECT_EQ(fine.linear().M, stage.machine.linear().M);
  EXPECT_EQ(fine.linear().D, stage.machine.linear().D);
  EXPECT_EQ(fine.linear().K, stage.machine.linear().K);
  Trajectory motion = stage.setup().trajectories.Find("default");
  motion.duration = 1.0;
  const Excitation excitation = FollowTrajectory(stage.setup(), motion);
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Record one = Simulate(stage.machine, excitation, quiet);
  const Record other = Simulate(fine, excitation, quiet);
  ASSERT_EQ(one.samples(), other.samples());
  ASSERT_GT(one.At("q").samples.maxCoeff(), 0.02);
  // The integrator is of first order: at a speed of 0.1 m/s less than a step's way.
  const double difference =
      (one.At("q").samples - other.At("q").samples).lpNorm<Eigen::Infinity>();
  EXPECT_LT(difference, 0.1 * stage.setup().rates.step());
  EXPECT_GT(difference, 0.0);
}

TEST(Machine, RefusesATimeStepThatDoesNotFitTheRates) {
  const mjdiag::Setup setup =
      ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps", {"rates.substeps=4"});
  EXPECT_THAT(test::MessageOf<InputError>([&] { Machine machine(setup); }),
              AllOf(HasSubstr("time step 200.0"), HasSubstr("250.0")));
}

// A record has a clock of its own; the time step of a plant has as many digits as it has.
TEST(Machine, TakesTheTimeStepOfTheRatesWhereItIsNearly) {
  const Machine nearly(
      ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps", {"rates.control=1001"}));
  EXPECT_EQ(nearly.plant().opt.timestep, nearly.setup().rates.step());
  EXPECT_NEAR(nearly.plant().opt.timestep, 199.8e-6, 1e-9);
}

/// The stage of mjcf/emps with its MJCF changed.
Machine StageWith(const std::string& from, const std::string& to) {
  const std::filesystem::path stage = MJDIAG_SOURCE_DIR "/mjcf/emps";
  std::string mjcf = ReadTextFile(stage / "plant.xml");
  mjcf.replace(mjcf.find(from), from.size(), to);
  const test::TemporaryFolder folder;
  folder.Write("plant.xml", mjcf);
  folder.Write("setup.toml", ReadTextFile(stage / "setup.toml"));
  return Machine(ReadSetup(folder.path()));
}

TEST(Machine, HasNoLinearPlantOfAnIntegratorOfSeveralStages) {
  const Machine stage = StageWith("integrator=\"Euler\"", "integrator=\"RK4\"");
  EXPECT_THAT(test::MessageOf<InputError>([&] { (void)stage.linear(); }),
              HasSubstr("integrator RK4"));
}

TEST(Machine, HasTheEffectsThatItsMjcfCarriesBeforeThoseOfItsChanges) {
  const Machine carrying = StageWith(
      "  </custom>",
      "    <numeric name=\"effect.viscous_friction.load\" data=\"17\"/>\n"
      "    <numeric name=\"effect.force_offset.load\" data=\"2\"/>\n  </custom>");
  EXPECT_DOUBLE_EQ(DampingOf(carrying, "load"), 203.5 + 17.0);
  EXPECT_EQ(carrying.changes(), Changes{});
  const Machine changed =
      carrying.With(test::With({"viscous_friction@load:coefficient=3"}));
  // What the file carries is not put in again.
  EXPECT_DOUBLE_EQ(DampingOf(changed, "load"), 203.5 + 17.0 + 3.0);
  EXPECT_THAT(EffectsIn(changed), ElementsAre("viscous_friction@load:coefficient=17",
                                              "force_offset@load:force=2",
                                              "viscous_friction@load:coefficient=3"));
}

TEST(Machine, NamesASensorThatThePlantLacks) {
  EXPECT_THAT(test::MessageOf<InputError>(
                  [] { StageWith("name=\"load_encoder\"", "name=\"other_encoder\""); }),
              HasSubstr("load_encoder"));
}

// Against the same machine with steps a sixteenth as long, from which a sixteenth of the
// first order is left: a tenth covers that and the second order.
TEST(Machine, WithoutStepsIsWhatFinerAndFinerOnesComeTo) {
  const Machine machine = test::Bonder();
  RunOptions options;
  options.noise_scale = 0.0;
  const auto outputs = [&](const Machine& one) {
    return ToMeasuredRun(machine.setup(),
                         Simulate(one, DefaultMotion(machine.setup()), options))
        .outputs;
  };
  const Eigen::MatrixXd fine =
      outputs(machine.WithSubsteps(16 * machine.rates().substeps));
  const Eigen::MatrixXd of_steps = outputs(machine) - fine;
  const Eigen::MatrixXd left = outputs(machine.WithoutSteps()) - fine;
  for (Eigen::Index sensor = 0; sensor < fine.rows(); ++sensor) {
    EXPECT_GT(of_steps.row(sensor).norm(), 0.0) << sensor;
    EXPECT_LT(left.row(sensor).norm(), 0.1 * of_steps.row(sensor).norm()) << sensor;
  }
}

// A tenth of the steps is left of a share of nine tenths; the inertia of a slide that moves by
// itself is a constant of MuJoCo's, which has to be made anew.
TEST(Machine, TakesAShareOfTheStepsOfASlideThatMovesByItself) {
  const Machine machine = test::Stage().machine.WithSubsteps(1);
  const auto outputs = [&](const Machine& one) {
    RunOptions options;
    options.noise_scale = 0.0;
    return ToMeasuredRun(machine.setup(),
                         Simulate(one, DefaultMotion(machine.setup()), options))
        .outputs;
  };
  const Eigen::MatrixXd fine = outputs(machine.WithSubsteps(10));
  const double of_steps = (outputs(machine) - fine).norm();
  EXPECT_GT(of_steps, 0.0);
  EXPECT_LT((outputs(machine.WithoutSteps(0.9)) - fine).norm(), 0.1 * of_steps);
  const auto mass = [](const Machine& one) { return one.plant().dof_M0[0]; };
  const double h = machine.plant().opt.timestep;
  EXPECT_NEAR(mass(machine) - mass(machine.WithoutSteps(0.9)), 0.9 * 0.5 * h * 203.5,
              1e-9);
}

}  // namespace
}  // namespace mjdiag
