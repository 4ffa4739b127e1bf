#include "mjdiag/plugin/runtime/instance.h"

#include <gtest/gtest.h>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/changes.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

/// The bonder, or what has become of it, at the start of its default motion.
struct Bench {
  explicit Bench(const RunOptions& options = {}, const Changes& changes = {})
      : machine(test::Bonder().With(changes)),
        plant(StartPlant(machine, {})),
        instance(machine, Motion(machine.setup()), options) {}

  static Excitation Motion(const Setup& setup) {
    return FollowTrajectory(setup,
                            setup.trajectories.Find(setup.trajectories.fallback));
  }
  void Step(int steps) {
    for (int i = 0; i < steps; ++i) mj_step(plant.model.get(), plant.data.get());
  }
  void AttachInstance() { Attach(*plant.model, *plant.data, instance); }

  Machine machine;
  StartedPlant plant;
  Instance instance;
};

#if !MJDIAG_SANITIZED
mjfGeneric counted_callback = nullptr;
long allocations = 0;
void CountingCallback(const mjModel* model, mjData* data) {
  allocations += test::CountAllocations([&] { counted_callback(model, data); });
}

/// Of a closed loop over 1000 ticks.
long AllocationsInTheCallback(const RunOptions& options, const Changes& changes = {}) {
  Bench bench(options, changes);
  bench.AttachInstance();
  counted_callback = mjcb_control;
  mjcb_control = CountingCallback;
  allocations = 0;
  bench.Step(4000);
  mjcb_control = counted_callback;
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1000);
  return allocations;
}

TEST(ControlCallback, DoesNotAllocate) {
  RunOptions options;
  options.log_joints = true;
  options.disturbances["gamma"] = 0.01;
  EXPECT_EQ(AllocationsInTheCallback(options, test::With({"force_offset@X:force=1"})),
            0);

  Eigen::VectorXd proof;
  EXPECT_GT(test::CountAllocations([&] { proof.resize(100); }), 0)
      << "the counter does not count";
}

TEST(ControlCallback, DoesNotAllocateWithADiagnosisInIt) {
  // With every residual of the null space, a baseline and a recorder that is full
  // before the run ends.
  const Machine machine = test::Bonder(
      {"diagnosis.estimation.rows=0", "diagnosis.estimation.forgetting=0.1"});
  for (const bool at_rest : {true, false}) {
    DiagnosisDesign design = DesignFilters(machine);
    // Away from rest the filters settle on the first reading.
    if (!at_rest) design.offset.array() += 1e-3;
    design.limits.residual.limits = {-1.0, 1.0};
    design.limits.known = true;
    DiagnosisRecording recording(design, 500,
                                 Eigen::MatrixXd::Zero(design.bank.residuals, 700));
    MonitorObserver observer(recording);
    RunOptions options;
    options.observer = &observer;
    EXPECT_EQ(AllocationsInTheCallback(options), 0);
    EXPECT_EQ(recording.monitor.samples(), 1000);
    EXPECT_EQ(recording.recorder.Log().residual.size(), 500);
    EXPECT_TRUE(!at_rest || recording.monitor.estimate().norm() > 0.0);
  }
}
#endif

TEST(ControlCallback, LeavesDataWithoutAnInstanceAlone) {
  Bench controlled;
  controlled.AttachInstance();
  const DataPtr other = MakeData(*controlled.plant.model);
  other->ctrl[0] = 1.5;
  mj_step(controlled.plant.model.get(), other.get());
  EXPECT_EQ(other->ctrl[0], 1.5);
  EXPECT_EQ(controlled.instance.loop().ticks_done(), 0);
}

TEST(ControlCallback, StopsAfterResetAndAfterDetach) {
  Bench bench;
  bench.AttachInstance();
  bench.Step(1);
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1);
  mj_resetData(bench.plant.model.get(), bench.plant.data.get());
  bench.Step(8);
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1);
  bench.AttachInstance();
  Detach(*bench.plant.model, *bench.plant.data);
  bench.Step(8);
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1);
}

TEST(ControlCallback, TicksOnceEverySubsteps) {
  Bench bench;
  bench.AttachInstance();
  bench.Step(9);
  EXPECT_EQ(bench.machine.rates().substeps, 4);
  EXPECT_EQ(bench.instance.loop().ticks_done(), 3);
}

TEST(ControlCallback, RefusesAModelWithoutRoomForItsMark) {
  Bench bench;
  const ModelPtr bare =
      LoadModel(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/emps/plant.xml");
  const DataPtr data = MakeData(*bare);
  EXPECT_THROW(Attach(*bare, *data, bench.instance), InputError);
}

TEST(Instance, NamesAMissingSensorAndActuator) {
  const Machine machine = test::Bonder();
  Channels channels = machine.channels();
  channels.sensors[0].component = 7;
  EXPECT_THROW(SensorAddresses(channels, machine.plant()), InputError);
  channels.sensors[0].element = "ghost";
  EXPECT_THROW(SensorAddresses(channels, machine.plant()), InputError);
  channels.actuators[0].element = "ghost";
  EXPECT_THROW(ActuatorAddresses(channels, machine.plant()), InputError);
}

}  // namespace
}  // namespace mjdiag
