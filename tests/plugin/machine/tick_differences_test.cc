#include "mjdiag/plugin/machine/tick_differences.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "mjdiag/plugin/effects/placed_effect.h"
#include "support/any_machine.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class HeldInput final : public TickControl {
 public:
  explicit HeldInput(double value) : value_(value) {}
  void Tick(std::span<const double>, std::span<double> inputs) noexcept override {
    std::ranges::fill(inputs, value_);
  }

 private:
  double value_;
};

/// Somewhere in motion.
PlantState SomeState(const mjModel& model) {
  PlantState state{VectorXd::Map(model.qpos0, model.nq), VectorXd(model.nv),
                   VectorXd::Constant(model.na, 0.3)};
  VectorXd dx = VectorXd::Zero(TangentSize(model));
  for (Index i = 0; i < model.nv; ++i) {
    dx[i] = 0.02 + 0.01 * static_cast<double>(i);
    state.velocity[i] = 0.1 - 0.07 * static_cast<double>(i % 3);
  }
  return Moved(model, state, dx);
}

TickTangent TangentAt(const Machine& machine, const PlantState& state, double input) {
  TickMap map(machine);
  HeldInput control(input);
  const VectorXd none = VectorXd::Zero(machine.plant().nv);
  map.Run(state, none, 0, control);
  return TickDifferences(map, machine.rates().tick(), AllDofs(machine.plant()))
      .Of(state, none, 0, control);
}

using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

/// MuJoCo's own, of one physics step.
struct OfMuJoCo {
  RowMajor A, C;
};

OfMuJoCo StepOfMuJoCo(const mjModel& plant, const PlantState& state, double input) {
  const ModelPtr model = CopyModel(plant);
  model->opt.solver = mjSOL_NEWTON;
  model->opt.tolerance = 1e-14;
  model->opt.iterations = 100;
  const DataPtr data = MakeData(*model);
  SetState(*model, state, *data);
  std::fill_n(data->ctrl, model->nu, input);
  const Index ns = TangentSize(*model);
  OfMuJoCo step{RowMajor(ns, ns), RowMajor(model->nsensordata, ns)};
  mjd_transitionFD(model.get(), data.get(), 1e-6, 1, step.A.data(), nullptr,
                   step.C.data(), nullptr);
  return step;
}

double Relative(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).norm() / std::max(b.norm(), 1e-12);
}

class EveryKind : public ::testing::TestWithParam<test::AnyKind> {};

TEST_P(EveryKind, HasTheTangentOfMuJoCosOwnStep) {
  const Machine machine = test::MachineOf(GetParam());
  const mjModel& model = machine.plant();
  const PlantState state = SomeState(model);
  const TickTangent tangent = TangentAt(machine, state, 0.4);
  const OfMuJoCo step = StepOfMuJoCo(model, state, 0.4);
  EXPECT_LT(Relative(tangent.A, step.A), 1e-6);
  // A setup reads the first component.
  EXPECT_LT(Relative(tangent.C, step.C.topRows(1)), 1e-6);
}

TEST_P(EveryKind, MovesAsItsTangentSays) {
  const Machine machine = test::MachineOf(GetParam());
  const mjModel& model = machine.plant();
  const PlantState state = SomeState(model);
  const TickTangent tangent = TangentAt(machine, state, 0.4);
  TickMap map(machine);
  HeldInput control(0.4);
  VectorXd dx(TangentSize(model));
  for (Index i = 0; i < dx.size(); ++i) dx[i] = i % 2 == 0 ? 3e-5 : -2e-5;
  VectorXd force(model.nv);
  for (Index i = 0; i < model.nv; ++i) force[i] = 1e-3 * static_cast<double>(i + 1);
  const VectorXd none = VectorXd::Zero(model.nv);
  const PlantState there = map.Run(state, none, 0, control).state;
  const PlantState moved = map.Run(Moved(model, state, dx), force, 0, control).state;
  const VectorXd expected = tangent.A * dx + tangent.B * force;
  EXPECT_LT((Deviation(model, there, moved) - expected).norm(), 2e-3 * expected.norm());
}

TEST(TickDifferences, AreThoseOfRungeKuttaSteps) {
  const Machine machine = test::MachineOf(test::kRungeKutta);
  const PlantState state = SomeState(machine.plant());
  const DataPtr data = MakeData(machine.plant());
  const auto step = [&](double dq, double dv) -> Eigen::Vector2d {
    SetState(machine.plant(), state, *data);
    data->qpos[0] += dq;
    data->qvel[0] += dv;
    data->ctrl[0] = 0.4;
    mj_step(&machine.plant(), data.get());
    return {data->qpos[0], data->qvel[0]};
  };
  constexpr double h = 1e-6;
  Eigen::Matrix2d A;
  A << (step(h, 0.0) - step(-h, 0.0)) / (2.0 * h),
      (step(0.0, h) - step(0.0, -h)) / (2.0 * h);
  EXPECT_LT(Relative(TangentAt(machine, state, 0.4).A, A), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Models, EveryKind, ::testing::ValuesIn(test::kEveryKind),
                         [](const auto& of) {
                           std::string name = of.param.name;
                           std::erase_if(name,
                                         [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

// What ships, without friction that sticks.
class Shipped : public ::testing::TestWithParam<std::string> {
 protected:
  const Machine machine_{ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/" + GetParam(),
                                   {"physics.static_friction=false"})};
};

class ShippedAtRest : public Shipped {};

// The exact linear map of a tick of several steps, at rest. The servo's has the damping of its
// motor, back EMF, at the end of a step, as that of joints; MuJoCo's Euler step at its beginning.
TEST_P(ShippedAtRest, HasTheTangentOfItsLinearModel) {
  const mjModel& model = machine_.plant();
  const PlantState rest{machine_.rest(), VectorXd::Zero(model.nv), VectorXd(0)};
  const TickTangent tangent = TangentAt(machine_, rest, 0.0);
  const StateSpace tick =
      TickModel(machine_.linear(), machine_.rates().step(), machine_.rates().substeps);
  // The bonder has coordinates of 1e8 N/m beside some of 1 N m/rad: differences of ticks
  // carry the rounding of the largest.
  EXPECT_LT(Relative(tangent.A, tick.A), 1e-6);
  EXPECT_LT(Relative(tangent.B * machine_.linear().Gamma, tick.B), 1e-6);
  EXPECT_LT(Relative(tangent.C, tick.C), 1e-6);
}

TEST_P(Shipped, HasInMotionTheTangentOfMuJoCosOwnStep) {
  const mjModel& model = machine_.plant();
  PlantState state{machine_.rest(), VectorXd(model.nv), VectorXd(0)};
  VectorXd dx = VectorXd::Zero(TangentSize(model));
  // Guides of the bonder give by a micrometre.
  for (Index i = 0; i < model.nv; ++i) {
    const double give = model.jnt_stiffness[model.dof_jntid[i]] > 100.0 ? 1e-5 : 1.0;
    dx[i] = give * (0.02 + 0.01 * static_cast<double>(i));
    state.velocity[i] = give * (0.1 - 0.07 * static_cast<double>(i % 3));
  }
  state = Moved(model, state, dx);
  TickMap map(machine_);
  HeldInput control(0.4);
  const VectorXd none = VectorXd::Zero(model.nv);
  map.Run(state, none, 0, control);
  TickDifferences differences(map, machine_.rates().tick(), AllDofs(model));
  const TickTangent tangent = differences.OfFirstStep(state, none, 0, control);
  const OfMuJoCo step = StepOfMuJoCo(model, state, 0.4);
  EXPECT_LT(Relative(tangent.A, step.A), 1e-6);
  MatrixXd C(tangent.C.rows(), tangent.C.cols());
  for (Index i = 0; i < C.rows(); ++i) {
    C.row(i) = step.C.row(machine_.sensor_addresses()[static_cast<std::size_t>(i)]);
  }
  EXPECT_LT(Relative(tangent.C, C), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Machines, ShippedAtRest,
                         ::testing::Values("ab383", "emps", "panda", "voice_coil"),
                         [](const auto& of) { return of.param; });
INSTANTIATE_TEST_SUITE_P(Machines, Shipped,
                         ::testing::Values("ab383", "emps", "panda", "servo",
                                           "voice_coil"),
                         [](const auto& of) { return of.param; });

// Within 5 ms an arm at 0.1 rad/s turns by half a milliradian, by which springs, dampers and
// inertia change little more.
TEST(TickDifferences, OfAFirstStepRepeatedAreThoseOfTheTick) {
  const Machine machine = test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="a" type="hinge" axis="0 1 0" damping="0.4"/>
      <inertial pos="0.1 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
      <body pos="0.3 0 0"><joint name="b" type="hinge" axis="0 1 0" stiffness="20"/>
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body>
      </body></worldbody><actuator><motor name="u" joint="a"/></actuator>
      <sensor><jointpos name="y" joint="b"/></sensor></mujoco>)",
      "[rates]\ncontrol = 200.0\nsubsteps = 5\n[sensors.y]\nelement = \"y\"\n"
      "unit = \"rad\"\n[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n");
  TickMap map(machine);
  HeldInput control(0.3);
  const VectorXd none = VectorXd::Zero(2);
  const PlantState state = SomeState(machine.plant());
  map.Run(state, none, 0, control);
  TickDifferences differences(map, machine.rates().tick(), AllDofs(machine.plant()));
  const TickTangent tick = differences.Of(state, none, 0, control);
  const TickTangent repeated =
      Repeated(differences.OfFirstStep(state, none, 0, control), 5);
  EXPECT_LT(Relative(repeated.A, tick.A), 1e-4);
  EXPECT_LT(Relative(repeated.B, tick.B), 1e-3);
  EXPECT_LT(Relative(repeated.C, tick.C), 1e-9);
}

TEST(TickMap, ReadsForcesAtTheEndOfTheTickThatTheyMove) {
  const Machine machine = test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="j" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody>
      <actuator><motor name="u" joint="j" gear="3"/></actuator>
      <sensor><jointpos name="q" joint="j"/><actuatorfrc name="f" actuator="u"/></sensor>
      </mujoco>)",
      "[rates]\ncontrol = 1000.0\n[sensors.q]\nelement = \"q\"\nunit = \"m\"\n"
      "[sensors.f]\nelement = \"f\"\nunit = \"N\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N\"\n");
  TickMap map(machine);
  HeldInput control(1.5);
  const PlantState still{VectorXd::Zero(1), VectorXd::Zero(1), VectorXd(0)};
  const TickMap::Result& tick = map.Run(still, VectorXd::Zero(1), 0, control);
  EXPECT_FALSE(map.ReadsAtEnd(0));
  EXPECT_TRUE(map.ReadsAtEnd(1));
  EXPECT_DOUBLE_EQ(tick.reading[1], 1.5);
  EXPECT_DOUBLE_EQ(tick.state.velocity[0], 3.0 * 1.5 / 2.0 * 0.001);
}

// Presliding goes on from one run to the next, and probes leave it where it was.
TEST(TickMap, ProbesFromWhatEffectsRememberedBefore) {
  const Machine machine = test::MachineOf(test::kEveryKind[0])
                              .With({{},
                                     {ParseEffect("presliding_hysteresis@j:"
                                                  "force=0.5,stiffness=500")}});
  TickMap map(machine);
  HeldInput control(0.0);
  const VectorXd none = VectorXd::Zero(1);
  PlantState state{VectorXd::Zero(1), VectorXd::Constant(1, 0.5), VectorXd(0)};
  for (int k = 0; k < 5; ++k) state = map.Run(state, none, k, control).state;
  const PlantState from = state;
  const PlantState to = map.Run(from, none, 5, control).state;
  map.Probe(Moved(map.model(), from, VectorXd::Constant(2, 0.1)), none, 5, control);
  EXPECT_EQ(map.Probe(from, none, 5, control).state.velocity[0], to.velocity[0]);
  // It is what the sixth tick does, and not the first.
  TickMap fresh(machine);
  EXPECT_NE(fresh.Run(from, none, 5, control).state.velocity[0], to.velocity[0]);
}

void ExpectSame(const TickMap::Result& a, const TickMap::Result& b) {
  EXPECT_EQ(a.state.position, b.state.position);
  EXPECT_EQ(a.state.velocity, b.state.velocity);
  EXPECT_EQ(a.state.activation, b.state.activation);
  EXPECT_EQ(a.reading, b.reading);
  EXPECT_EQ(a.pattern, b.pattern);
}

// What follows from positions is kept from one probe to the next, of every kind of model.
TEST(TickMap, StepsTheSameFromWhereItHasJustBeen) {
  for (const test::AnyKind& model : test::kEveryKind) {
    SCOPED_TRACE(model.name);
    const Machine machine = test::MachineOf(model);
    HeldInput control(0.4);
    const VectorXd none = VectorXd::Zero(machine.plant().nv);
    const PlantState from = SomeState(machine.plant());
    PlantState faster = from;
    faster.velocity.array() += 0.01;
    PlantState elsewhere = Moved(machine.plant(), from,
                                 VectorXd::Constant(TangentSize(machine.plant()), 0.1));
    TickMap here(machine), there(machine);
    here.Run(from, none, 0, control);
    there.Run(from, none, 0, control);
    here.ProbeStep(from, none, 0, control);
    there.ProbeStep(elsewhere, none, 0, control);
    const TickMap::Result& a = here.ProbeStep(faster, none, 0, control);
    const TickMap::Result& b = there.ProbeStep(faster, none, 0, control);
    ExpectSame(a, b);
    // And elsewhere not what was there.
    TickMap anew(machine);
    anew.Run(elsewhere, none, 0, control);
    ExpectSame(here.ProbeStep(elsewhere, none, 0, control),
               anew.ProbeStep(elsewhere, none, 0, control));
  }
}

// A mass on a spring on a mass: by the effect, and as two bodies of the model.
TEST(TickDifferences, HaveTheBodyOfAnEffectAsAState) {
  const std::string rest =
      "</body></worldbody><actuator><motor name=\"u\" joint=\"q\"/></actuator>"
      "<sensor><jointpos name=\"y\" joint=\"q\"/></sensor>";
  const std::string first =
      "<option timestep=\"0.001\" gravity=\"0 0 0\"/><worldbody><body>"
      "<joint name=\"q\" type=\"slide\" axis=\"1 0 0\"/>"
      "<inertial pos=\"0 0 0\" mass=\"2\" diaginertia=\"1 1 1\"/>";
  const std::string second =
      "<body><joint name=\"x\" type=\"slide\" axis=\"1 0 0\" stiffness=\"8000\"/>"
      "<inertial pos=\"0 0 0\" mass=\"0.8\" diaginertia=\"1 1 1\"/></body>";
  const double frequency = 100.0 / (2.0 * std::numbers::pi);  // sqrt(8000 / 0.8) = 100
  const std::string one = first + rest;
  const std::string two = first + second + rest;
  const Machine carries =
      test::MachineOf({"one", one.c_str()})
          .With({{},
                 {ParseEffect("flexible_mode@q:mass=0.8,frequency=" +
                              std::to_string(frequency) + ",damping_ratio=0")}});
  const Machine native = test::MachineOf({"two", two.c_str()});
  const Eigen::Vector2d q(0.01, 0.013);
  const Eigen::Vector2d v(0.2, -0.1);
  const PlantState state{q.head<1>(), v.head<1>(), VectorXd(0),
                         Eigen::Vector2d(q[1], v[1])};
  const PlantState of_two{Eigen::Vector2d(q[0], q[1] - q[0]),
                          Eigen::Vector2d(v[0], v[1] - v[0]), VectorXd(0)};
  // [q, q', x, x'] of [q, x - q, q', x' - q'], and back.
  Eigen::Matrix4d T;
  Eigen::Matrix4d back;
  T << 1, 0, 0, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 1;
  back << 1, 0, 0, 0, -1, 0, 1, 0, 0, 1, 0, 0, 0, -1, 0, 1;
  const TickTangent a = TangentAt(carries, state, 0.4);
  const TickTangent b = TangentAt(native, of_two, 0.4);
  // The frequency is written with six decimals.
  EXPECT_LT(Relative(a.A, T * b.A * back), 1e-6);
  EXPECT_LT(Relative(a.B, T * b.B.col(0)), 1e-6);
  EXPECT_LT(Relative(a.C, b.C * back), 1e-6);
}

// Where a joint sticks its tangent says that no force moves it; over forces of up to ten times
// the friction, nine tenths of what moves it without.
TEST(TickDifferences, AreSecantsOverWhatIsNotKnownOfAStickingJoint) {
  const Machine slide = test::MachineOf(
      {"slide",
       "<option timestep=\"0.001\" gravity=\"0 0 0\"/><worldbody><body>"
       "<joint name=\"q\" type=\"slide\" axis=\"1 0 0\"/>"
       "<inertial pos=\"0 0 0\" mass=\"2\" diaginertia=\"1 1 1\"/></body></worldbody>"
       "<actuator><motor name=\"u\" joint=\"q\"/></actuator>"
       "<sensor><jointpos name=\"y\" joint=\"q\"/></sensor>"});
  const Machine sticks = slide.With({{}, {ParseEffect("coulomb_friction@q:force=1")}});
  const PlantState rest{VectorXd::Zero(1), VectorXd::Zero(1), VectorXd()};
  const double free = TangentAt(slide, rest, 0.0).B(1, 0);
  TickMap map(sticks);
  HeldInput control(0.0);
  const VectorXd none = VectorXd::Zero(1);
  map.Run(rest, none, 0, control);
  TickDifferences differences(map, sticks.rates().tick(), AllDofs(sticks.plant()));
  TickTangent tangent = differences.Of(rest, none, 0, control);
  EXPECT_LT(tangent.B(1, 0), 0.02 * free);
  const std::vector<Index> dofs{0};
  differences.Refresh(rest, none, 0, control, dofs, false, true,
                      VectorXd::Constant(2, 1e-6), VectorXd::Constant(1, 10.0),
                      tangent);
  // MuJoCo's friction is right to a hundredth.
  EXPECT_NEAR(tangent.B(1, 0) / free, 0.9, 0.01);
}

}  // namespace
}  // namespace mjdiag
