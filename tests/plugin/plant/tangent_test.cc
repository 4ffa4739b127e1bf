#include "mjdiag/plugin/plant/tangent.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/machine/stepper.h"
#include "support/bonder.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class NoInput final : public TickControl {
 public:
  void Tick(std::span<const double>, std::span<double> inputs) noexcept override {
    std::ranges::fill(inputs, 0.0);
  }
};

/// One control tick from a state under a constant force on every joint.
class OneTick {
 public:
  explicit OneTick(const Machine& machine)
      : machine_(machine), plant_(StartPlant(machine, {})) {
    // To the last digit, for differences are taken of what comes out.
    plant_.model->opt.tolerance = 0.0;
    plant_.model->opt.iterations = 200;
  }
  Index nv() const { return plant_.model->nv; }
  VectorXd rest() const {
    VectorXd state = VectorXd::Zero(2 * nv());
    state.head(nv()) = machine_.rest();
    return state;
  }

  VectorXd End(const VectorXd& state, const VectorXd& force,
               TangentRecorder* recorder = nullptr) const {
    const mjModel& model = *plant_.model;
    mjData& data = *plant_.data;
    mj_resetData(&model, &data);
    VectorXd::Map(data.qpos, nv()) = state.head(nv());
    VectorXd::Map(data.qvel, nv()) = state.tail(nv());
    VectorXd::Map(data.qfrc_applied, nv()) = force;
    Stepper stepper(machine_);
    NoInput control;
    stepper.Advance(model, data, control, [&] {
      if (recorder != nullptr) recorder->Substep(model, data);
    });
    VectorXd end(2 * nv());
    end << VectorXd::Map(data.qpos, nv()), VectorXd::Map(data.qvel, nv());
    return end;
  }

  TickTangent ByDifferences(const VectorXd& state, const VectorXd& force,
                            double state_step, double force_step) const {
    TickTangent tangent{MatrixXd(2 * nv(), 2 * nv()), MatrixXd(2 * nv(), nv())};
    for (Index i = 0; i < 2 * nv(); ++i) {
      const VectorXd d = state_step * VectorXd::Unit(2 * nv(), i);
      tangent.A.col(i) =
          (End(state + d, force) - End(state - d, force)) / (2.0 * state_step);
    }
    for (Index i = 0; i < nv(); ++i) {
      const VectorXd d = force_step * VectorXd::Unit(nv(), i);
      tangent.B.col(i) =
          (End(state, force + d) - End(state, force - d)) / (2.0 * force_step);
    }
    return tangent;
  }

  TickTangent Recorded(const Machine& nominal, const VectorXd& state,
                       const VectorXd& force) const {
    TangentRecorder recorder(nominal.plant(), nominal.linear());
    End(state, force, &recorder);
    return recorder.EndTick();
  }

 private:
  Machine machine_;
  StartedPlant plant_;
};

/// Largest difference of the entries of one row, over the largest of that row.
double Difference(const MatrixXd& a, const MatrixXd& b) {
  const VectorXd rows = b.rowwise().lpNorm<Eigen::Infinity>();
  return (rows.cwiseInverse().asDiagonal() * (a - b)).cwiseAbs().maxCoeff();
}

// A tick of the servo with its motor off is one of the servo without a motor.
TEST(Tangent, LacksTheBackEmfOfAMotorThatIsOff) {
  const Machine servo(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"));
  const ModelPtr bare = CopyModel(servo.plant());
  bare->actuator_biastype[0] = mjBIAS_NONE;
  const Machine without(servo.setup(), *bare);
  const VectorXd state = Eigen::Vector2d(1e-3, 0.1);
  const VectorXd force = VectorXd::Zero(1);
  const TickTangent expected = OneTick(without).Recorded(without, state, force);

  TangentRecorder recorder(servo.plant(), servo.linear());
  const StartedPlant plant = StartPlant(servo, {});
  Stepper stepper(servo);
  NoInput control;
  const std::vector<int> off{0};
  stepper.Advance(*plant.model, *plant.data, control,
                  [&] { recorder.Substep(*plant.model, *plant.data, off); });
  EXPECT_LT(Difference(recorder.EndTick().A, expected.A), 1e-9);
}

TEST(Tangent, HasTheBackEmfOfTheMotorThatRuns) {
  const Machine servo(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"));
  const Machine weak = servo.With(test::With({"motor_constant@motor:factor=0.5"}));
  const VectorXd state = Eigen::Vector2d(1e-3, 0.1);
  const VectorXd force = VectorXd::Zero(1);
  const OneTick tick(weak);
  const MatrixXd expected = tick.Recorded(weak, state, force).A;
  EXPECT_LT(Difference(tick.Recorded(servo, state, force).A, expected), 1e-9);
  EXPECT_GT(Difference(OneTick(servo).Recorded(servo, state, force).A, expected), 1e-3);
}

/// The stage with 20 N of dry friction, which its model lacks.
struct RubbingStage {
  Machine nominal = test::Stage().machine;
  OneTick tick{nominal.With(test::With({"coulomb_friction@load:force=20"}))};
};

TEST(Tangent, OfASlidingJointIsThatOfThePlantWithoutFriction) {
  const RubbingStage stage;
  const VectorXd state = Eigen::Vector2d(0.02, 0.1);
  const VectorXd force = VectorXd::Constant(1, 5.0);
  const TickTangent recorded = stage.tick.Recorded(stage.nominal, state, force);
  const TickTangent differences = stage.tick.ByDifferences(state, force, 1e-6, 1e-2);
  EXPECT_LT(Difference(recorded.A, differences.A), 1e-6);
  EXPECT_LT(Difference(recorded.B, differences.B), 1e-6);
  const OneTick smooth(stage.nominal);
  const TickTangent without = smooth.Recorded(stage.nominal, state, force);
  EXPECT_EQ(recorded.A, without.A);
  EXPECT_EQ(recorded.B, without.B);
}

TEST(Tangent, OfAStickingJointIsThatOfThePlantThatFrictionHolds) {
  const RubbingStage stage;
  const VectorXd state = Eigen::Vector2d(0.02, 0.0);
  const VectorXd force = VectorXd::Constant(1, 5.0);
  const TickTangent recorded = stage.tick.Recorded(stage.nominal, state, force);
  const TickTangent differences = stage.tick.ByDifferences(state, force, 1e-8, 1e-2);
  EXPECT_LT(Difference(recorded.A, differences.A), 1e-5);
  EXPECT_LT(Difference(recorded.B, differences.B), 1e-5);
  // It moves by a small part of what it would without.
  const TickTangent free = OneTick(stage.nominal).Recorded(stage.nominal, state, force);
  EXPECT_LT(recorded.B(1, 0), 0.2 * free.B(1, 0));
}

// 5 N below what the friction can hold, and another change of the plant besides.
TEST(Tangent, IsOfTheMachineWithItsChanges) {
  const Machine nominal = test::Stage().machine;
  const Machine changed = nominal.With(
      test::With({"viscous_friction@load:coefficient=4000",
                  "linear_stiffness@load:stiffness=1e6", "added_mass@load:mass=-60"}));
  const OneTick tick(changed);
  const VectorXd state = Eigen::Vector2d(0.0, 0.1);
  const VectorXd force = VectorXd::Zero(1);
  const TickTangent recorded = tick.Recorded(nominal, state, force);
  const TickTangent differences = tick.ByDifferences(state, force, 1e-6, 1e-2);
  EXPECT_LT(Difference(recorded.A, differences.A), 1e-6);
  EXPECT_LT(Difference(recorded.B, differences.B), 1e-6);
}

// X slides, Y and Z stick. What the linear model leaves out is second order in the
// deflections of the guides.
TEST(Tangent, OfTheBonderKnowsWhichOfItsJointsStick) {
  const Machine bonder = test::Bonder();
  const OneTick tick(bonder);
  const Index nv = tick.nv();
  const int x = FindElement(bonder.plant(), mjOBJ_JOINT, "X");
  VectorXd state = tick.rest();
  state[nv + x] = 0.05;
  const VectorXd force = VectorXd::Zero(nv);
  const TickTangent recorded = tick.Recorded(bonder, state, force);
  const TickTangent differences = tick.ByDifferences(state, force, 1e-10, 1e-4);
  EXPECT_LT(Difference(recorded.A, differences.A), 1e-3);
  EXPECT_LT(Difference(recorded.B, differences.B), 1e-3);
  // It matters.
  const Machine smooth = test::Bonder({"physics.static_friction=false"});
  const TickTangent free = OneTick(smooth).Recorded(smooth, state, force);
  EXPECT_GT(Difference(free.B, differences.B), 0.1);
}

TEST(Tangent, BeginsANewTickWithEveryEnd) {
  const RubbingStage stage;
  const VectorXd state = Eigen::Vector2d(0.02, 0.1);
  TangentRecorder recorder(stage.nominal.plant(), stage.nominal.linear());
  stage.tick.End(state, VectorXd::Zero(1), &recorder);
  const TickTangent first = recorder.EndTick();
  stage.tick.End(state, VectorXd::Zero(1), &recorder);
  EXPECT_EQ(recorder.EndTick().A, first.A);
  EXPECT_EQ(recorder.EndTick().A, MatrixXd::Identity(2, 2));
}

}  // namespace
}  // namespace mjdiag
