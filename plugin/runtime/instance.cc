#include "mjdiag/plugin/runtime/instance.h"

#include <bit>
#include <mutex>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/instance_slot.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr double kMark = 7.2657474e-169;
static_assert(sizeof(mjtNum) == sizeof(void*), "a slot must hold a pointer");

mjtNum* Slots(const mjModel& model, const mjData& data) {
  return model.nuserdata < kInstanceSlots
             ? nullptr
             : data.userdata + model.nuserdata - kInstanceSlots;
}

// What was installed before; serves the data that carry no mark.
mjfGeneric previous_callback = nullptr;

void ControlCallback(const mjModel* model, mjData* data) {
  const mjtNum* slots = Slots(*model, *data);
  if (slots != nullptr && slots[0] == kMark) {
    auto* instance = std::bit_cast<Instance*>(slots[1]);
    instance->OnStep(*model, *data);
  } else if (previous_callback != nullptr) {
    previous_callback(model, data);
  }
}

// A callback that somebody installs after this one is taken to pass on what is not its
// own; one that was taken off is put back.
void InstallControlCallback() {
  static std::mutex mutex;
  static bool installed = false;
  const std::lock_guard lock(mutex);
  if (installed && mjcb_control != nullptr) return;
  if (mjcb_control != nullptr) previous_callback = mjcb_control;
  mjcb_control = ControlCallback;
  installed = true;
}

}  // namespace

Instance::Instance(const Machine& machine, const Excitation& excitation,
                   const RunOptions& options)
    : loop_(machine.setup(), excitation, options), stepper_(machine) {
  if (options.log_joints) joints_.resize(machine.plant().nq, excitation.samples());
}

void Instance::OnStep(const mjModel& model, mjData& data) noexcept {
  if (stepper_.AtTickStart()) LogJoints(model, data);
  stepper_.OnStep(model, data, loop_);
}

void Instance::Release(mjData& data) noexcept { stepper_.Release(data); }

void Instance::LogJoints(const mjModel& model, const mjData& data) noexcept {
  const Eigen::Index k = loop_.ticks_done();
  if (k >= joints_.cols()) return;
  joints_.col(k) = Eigen::Map<const Eigen::VectorXd>(data.qpos, model.nq);
}

Record Instance::ToRecord(const mjModel& model) const {
  Record record = loop_.ToRecord();
  if (joints_.size() == 0) return record;
  for (int joint = 0; joint < model.njnt; ++joint) {
    const int type = model.jnt_type[joint];
    if (type != mjJNT_SLIDE && type != mjJNT_HINGE) continue;
    record.Add(JointChannel(
        model, joint, joints_.row(model.jnt_qposadr[joint]).head(record.samples())));
  }
  return record;
}

void Attach(const mjModel& model, mjData& data, Instance& instance) {
  mjtNum* slots = Slots(model, data);
  if (slots == nullptr) {
    throw InputError("model", "no room in mjData.userdata for the mark of an instance",
                     "a prepared model, or <size nuserdata=\"2\"/> in the MJCF");
  }
  InstallControlCallback();
  slots[0] = kMark;
  slots[1] = std::bit_cast<mjtNum>(&instance);
}

void Detach(const mjModel& model, mjData& data) {
  if (mjtNum* slots = Slots(model, data)) slots[0] = slots[1] = 0.0;
}

}  // namespace mjdiag
