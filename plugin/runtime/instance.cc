#include "mjdiag/plugin/runtime/instance.h"

#include <bit>
#include <cstdint>
#include <mutex>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// Two slots: a constant that no other user of userdata will hold, then the pointer.
constexpr int kSlots = 2;
constexpr double kMark = 7.2657474e-169;
static_assert(sizeof(mjtNum) == sizeof(std::uintptr_t), "a slot must hold a pointer");

mjtNum* Slots(const mjModel& model, const mjData& data) {
  return model.nuserdata < kSlots ? nullptr : data.userdata + model.nuserdata - kSlots;
}

// What was installed before; serves the data that carry no mark.
mjfGeneric previous_callback = nullptr;

void ControlCallback(const mjModel* model, mjData* data) {
  const mjtNum* slots = Slots(*model, *data);
  if (slots != nullptr && slots[0] == kMark) {
    auto* instance =
        reinterpret_cast<Instance*>(std::bit_cast<std::uintptr_t>(slots[1]));
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

Instance::Instance(const Setup& setup, const mjModel& model,
                   const Excitation& excitation, const RunOptions& options)
    : loop_(WithEncoderNoise(setup, model, options.effects), excitation, options),
      effects_(setup, model, options.effects),
      sample_time_(setup.sample_time()),
      substeps_(setup.substeps),
      sensor_address_(SensorAddresses(setup, model)),
      actuator_address_(ActuatorAddresses(setup, model)),
      outputs_(sensor_address_.size()),
      inputs_(actuator_address_.size()) {
  if (options.log_joints) joints_.resize(model.nq, excitation.samples());
}

void Instance::OnStep(const mjModel& model, mjData& data) noexcept {
  if (substep_ == 0) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      outputs_[i] = data.sensordata[sensor_address_[i]];
    }
    LogJoints(model, data);
    const double time = static_cast<double>(loop_.ticks_done()) * sample_time_;
    effects_.Distort(outputs_, time);
    loop_.Tick(outputs_, inputs_);
  }
  if (++substep_ == substeps_) substep_ = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    data.ctrl[actuator_address_[i]] = inputs_[i];
  }
  effects_.Act(model, data);
}

void Instance::Release(mjData& data) noexcept {
  for (const int address : actuator_address_) data.ctrl[address] = 0.0;
  effects_.Release(data);
}

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

void ReserveInstanceSlot(mjModel& model) { model.nuserdata += kSlots; }

void Attach(const mjModel& model, mjData& data, Instance& instance) {
  mjtNum* slots = Slots(model, data);
  if (slots == nullptr) {
    throw InputError("model", "no room in mjData.userdata for the mark of an instance",
                     "a prepared model, or <size nuserdata=\"2\"/> in the MJCF");
  }
  InstallControlCallback();
  slots[0] = kMark;
  slots[1] = std::bit_cast<double>(reinterpret_cast<std::uintptr_t>(&instance));
}

void Detach(const mjModel& model, mjData& data) {
  if (mjtNum* slots = Slots(model, data)) slots[0] = slots[1] = 0.0;
}

}  // namespace mjdiag
