#include "mjdiag.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "controlled_machine.h"
#include "guard.h"
#include "handle.h"
#include "host_callback.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/time_step.h"
#include "mjdiag/signals/record_file.h"

namespace {

using mjdiag::ControlledMachine;
using mjdiag::NotNull;
using mjdiag::Text;
using mjdiag::Try;
using Instances = mjdiag::Handles<mjdiag_instance>;

template <typename Handle>
auto& OpenedInstance(Handle* handle) {
  return mjdiag::Opened(handle, "an attached instance");
}

/// InputError for data that were made before the model was prepared: they have no room
/// for the mark of an instance.
void RequireDataOf(const mjModel& model, const mjData& data) {
  if (mjdiag::MakeData(model)->nbuffer == data.nbuffer) return;
  throw mjdiag::InputError("data", "not of the model as it is now",
                           "mjdiag_prepare first, then mj_makeData");
}

void PutAtRest(const mjdiag::Machine& machine, const mjModel& model, mjData& data) {
  const Eigen::VectorXd& start = machine.rest();
  mj_resetData(&model, &data);
  std::copy(start.begin(), start.end(), data.qpos);
}

}  // namespace

const char* mjdiag_version(void) { return MJDIAG_VERSION; }

const char* mjdiag_last_error(void) { return mjdiag::LastError().c_str(); }

int mjdiag_prepare(mjModel* model, const char* setup) {
  return Try([&] {
    NotNull(model, "a model");
    mjdiag::PreparePlant(mjdiag::ReadSetup(Text(setup)).physics, *model);
  });
}

int mjdiag_set_fault(mjModel* model, const char* parameter, double value) {
  return Try([&] {
    mjdiag::ApplyFault(*NotNull(model, "a model"), {Text(parameter), value});
  });
}

int mjdiag_rest(const mjModel* model, mjData* data, const char* setup) {
  return Try([&] {
    NotNull(model, "a model");
    RequireDataOf(*model, *NotNull(data, "data of the model"));
    PutAtRest(mjdiag::Machine(mjdiag::ReadSetup(Text(setup)), *model), *model, *data);
  });
}

mjdiag_instance* mjdiag_attach(const mjModel* model, mjData* data, const char* setup,
                               const char* trajectory, uint64_t seed) {
  mjdiag_instance* attached = nullptr;
  mjdiag::Guard([&] {
    NotNull(model, "a model");
    RequireDataOf(*model, *NotNull(data, "data of the model"));
    if (Instances::Any(
            [=](const ControlledMachine& other) { return other.data == data; })) {
      throw mjdiag::InputError("data", "an instance is attached to it",
                               "data without, or mjdiag_detach first");
    }
    mjdiag::Setup parts = mjdiag::ReadSetup(Text(setup));
    mjdiag::CheckTimeStep(parts, *model);
    const mjdiag::Machine machine(std::move(parts), *model);
    const mjdiag::Trajectories& known = machine.setup().trajectories;
    const mjdiag::Excitation excitation = mjdiag::FollowTrajectory(
        machine.setup(), known.Find(trajectory ? trajectory : known.fallback));
    auto made = std::make_unique<ControlledMachine>(
        ControlledMachine{model, data, machine.setup(), {}, nullptr});
    mjdiag::RunOptions options;
    options.seed = seed;
    options.observer = &made->relay;
    made->instance = std::make_unique<mjdiag::Instance>(machine, excitation, options);
    PutAtRest(machine, *model, *data);
    mjdiag::KeepHostCallbackOut();
    mjdiag::Attach(*model, *data, *made->instance);
    attached = Instances::Open(std::move(made));
  });
  return attached;
}

int64_t mjdiag_ticks(const mjdiag_instance* instance) {
  int64_t ticks = -1;
  mjdiag::Guard(
      [&] { ticks = OpenedInstance(instance).instance->loop().ticks_done(); });
  return ticks;
}

int mjdiag_write_record(const mjdiag_instance* instance, const char* file) {
  return Try([&] {
    const ControlledMachine& machine = OpenedInstance(instance);
    const std::filesystem::path path(Text(file));
    mjdiag::WriteRecord(path, machine.instance->ToRecord(*machine.model),
                        path.extension() == ".mat" ? mjdiag::RecordFormat::kMat5
                                                   : mjdiag::RecordFormat::kCsv);
  });
}

void mjdiag_detach(mjdiag_instance* instance) {
  if (instance == nullptr) return;
  if (const auto machine = Instances::Close(*instance)) {
    mjdiag::Detach(*machine->model, *machine->data);
    machine->instance->Release(*machine->data);
  }
}
