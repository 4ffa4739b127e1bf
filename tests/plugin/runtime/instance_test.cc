#include "mjdiag/plugin/runtime/instance.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/monitor_observer.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/signals/error.h"

// Counts every allocation of the thread while it is told to: Eigen calls malloc, the
// standard library operator new, which calls malloc. Sanitizers replace malloc
// themselves, so the count is left out there.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MJDIAG_COUNTS_ALLOCATIONS 0
#else
#define MJDIAG_COUNTS_ALLOCATIONS 1
namespace {
thread_local bool counting = false;
thread_local long allocations = 0;
}  // namespace
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_memalign(std::size_t, std::size_t);
extern "C" void* malloc(std::size_t size) {
  if (counting) ++allocations;
  return __libc_malloc(size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (counting) ++allocations;
  return __libc_memalign(alignment, size);
}
#endif

namespace mjdiag {
namespace {

struct Bench {
  explicit Bench(const RunOptions& options = {})
      : setup(ReadSetup(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/ab383")),
        model(LoadPlant(setup)),
        data(MakeData(*model)),
        instance(setup, *model,
                 FollowTrajectory(setup,
                                  setup.trajectories.Find(setup.trajectories.fallback)),
                 options) {
    const Eigen::VectorXd start = StartPosition(setup, *model, {});
    std::copy(start.begin(), start.end(), data->qpos);
  }
  mjdiag::Setup setup;
  ModelPtr model;
  DataPtr data;
  Instance instance;
};

#if MJDIAG_COUNTS_ALLOCATIONS
mjfGeneric counted_callback = nullptr;
void CountingCallback(const mjModel* model, mjData* data) {
  counting = true;
  counted_callback(model, data);
  counting = false;
}

/// Of a closed loop over 1000 ticks.
long AllocationsInTheCallback(const RunOptions& options) {
  Bench bench(options);
  Attach(*bench.model, *bench.data, bench.instance);
  counted_callback = mjcb_control;
  mjcb_control = CountingCallback;
  allocations = 0;
  for (int i = 0; i < 4000; ++i) mj_step(bench.model.get(), bench.data.get());
  mjcb_control = counted_callback;
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1000);
  return allocations;
}

TEST(ControlCallback, DoesNotAllocate) {
  RunOptions options;
  options.log_joints = true;
  options.disturbances["gamma"] = 0.01;
  options.effects = {ParseEffect("force_offset@X:force=1")};
  EXPECT_EQ(AllocationsInTheCallback(options), 0);

  allocations = 0;
  counting = true;
  Eigen::VectorXd proof(100);
  counting = false;
  EXPECT_GT(allocations, 0) << "the counter does not count";
  EXPECT_EQ(proof.size(), 100);
}

TEST(ControlCallback, DoesNotAllocateWithADiagnosisInIt) {
  // With every row of the null space, a baseline and a recorder that is full before the
  // run ends.
  const mjdiag::Setup setup =
      ReadSetup(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/ab383",
                {"diagnosis.estimation.rows=0", "diagnosis.estimation.forgetting=0.1"});
  for (const bool at_rest : {true, false}) {
    DiagnosisDesign design = DesignFilters(setup, *LoadPlant(setup));
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
  Attach(*controlled.model, *controlled.data, controlled.instance);
  const DataPtr other = MakeData(*controlled.model);
  other->ctrl[0] = 1.5;
  mj_step(controlled.model.get(), other.get());
  EXPECT_EQ(other->ctrl[0], 1.5);
  EXPECT_EQ(controlled.instance.loop().ticks_done(), 0);
}

TEST(ControlCallback, StopsAfterResetAndAfterDetach) {
  Bench bench;
  Attach(*bench.model, *bench.data, bench.instance);
  mj_step(bench.model.get(), bench.data.get());
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1);
  mj_resetData(bench.model.get(), bench.data.get());
  for (int i = 0; i < 8; ++i) mj_step(bench.model.get(), bench.data.get());
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1);
  Attach(*bench.model, *bench.data, bench.instance);
  Detach(*bench.model, *bench.data);
  for (int i = 0; i < 8; ++i) mj_step(bench.model.get(), bench.data.get());
  EXPECT_EQ(bench.instance.loop().ticks_done(), 1);
}

TEST(ControlCallback, TicksOnceEverySubsteps) {
  Bench bench;
  Attach(*bench.model, *bench.data, bench.instance);
  for (int i = 0; i < 9; ++i) mj_step(bench.model.get(), bench.data.get());
  EXPECT_EQ(bench.setup.rates.substeps, 4);
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
  Bench bench;
  mjdiag::Setup setup = bench.setup;
  setup.channels.sensors[0].component = 7;
  EXPECT_THROW(SensorAddresses(setup, *bench.model), InputError);
  setup.channels.sensors[0].element = "ghost";
  EXPECT_THROW(SensorAddresses(setup, *bench.model), InputError);
  setup.channels.actuators[0].element = "ghost";
  EXPECT_THROW(ActuatorAddresses(setup, *bench.model), InputError);
}

}  // namespace
}  // namespace mjdiag
