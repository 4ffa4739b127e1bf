#include "watch.h"

#include <algorithm>
#include <cmath>

#include "host_callback.h"
#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/time_step.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// Part of a control tick by which the clock of a simulation may be off.
constexpr double kSameTime = 1e-3;

bool AllFinite(std::span<const double> values) noexcept {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

}  // namespace

Watch::Watch(const char* setup, const char* filters, bool linear, Eigen::Index room)
    : room_(room) {
  if (setup == nullptr && filters == nullptr) {
    throw InputError("monitor", "neither setup nor filters", "at least one of them");
  }
  if (room < 0) {
    throw InputError("monitor", "room for " + std::to_string(room) + " ticks",
                     "0 or more");
  }
  KeepHostCallbackOut();
  if (setup == nullptr) {
    prepared_.design = ReadFilters(filters);
  } else {
    machine_.emplace(ReadSetup(setup));
    DiagnosisSource source;
    if (filters != nullptr) source.filters = filters;
    source.nominal.linear = linear;
    prepared_ = PrepareDiagnosis(*machine_, source);
  }
  faults_ = design().FaultNames();
  Restart();
}

void Watch::Restart() {
  // Made before the old one goes: where that fails, all is as it was.
  if (machine_) {
    recording_.emplace(BeginDiagnosis(*machine_, prepared_, room_));
  } else {
    recording_.emplace(DiagnosisRecording(prepared_.design, room_));
  }
  source_ = nullptr;
  ended_ = nullptr;
  finished_ = false;
  result_.reset();
  verdict_.clear();
  heard_.reset();
}

void Watch::TakeFrom(const void* source) {
  if (source_ != nullptr || ended_ != nullptr) {
    throw InputError("monitor", "its ticks come from somewhere else already",
                     "a monitor that is new or restarted");
  }
  source_ = source;
}

void Watch::ListenTo(const mjModel& model) {
  if (!machine_) {
    throw InputError("monitor", "opened without a setup, it knows no sensors",
                     "one with the setup of the machine");
  }
  CheckTimeStep(machine_->setup(), model);
  sensors_ = SensorAddresses(machine_->channels(), model);
  actuators_ = ActuatorAddresses(machine_->channels(), model);
  outputs_.resize(sensors_.size());
  inputs_.resize(actuators_.size());
  TakeFrom(&model);
}

const char* Watch::Take(const void* source, std::span<const double> outputs,
                        std::span<const double> inputs) noexcept {
  if (ended_ != nullptr) return ended_;
  if (source_ != source) return "monitor: its ticks come from somewhere else";
  return Add(outputs, inputs);
}

const char* Watch::TakeSample(std::span<const double> outputs,
                              std::span<const double> inputs) noexcept {
  const bool first = source_ == nullptr && ended_ == nullptr;
  const char* refusal = first ? Add(outputs, inputs) : Take(this, outputs, inputs);
  if (first && (refusal == nullptr || ended_ != nullptr)) source_ = this;
  return refusal;
}

const char* Watch::Add(std::span<const double> outputs,
                       std::span<const double> inputs) noexcept {
  if (outputs.size() != design().outputs.size() ||
      inputs.size() != design().inputs.size()) {
    return "monitor: a tick with another number of readings or commands; expected one "
           "for every channel of the filters";
  }
  if (!AllFinite(outputs) || !AllFinite(inputs)) {
    return End(
        "monitor: its run has ended with a reading or command that is no finite "
        "number; "
        "expected a restart");
  }
  recording_->Add(outputs, inputs);
  return nullptr;
}

const char* Watch::Hear(const mjModel& model, const mjData& data) noexcept {
  if (ended_ != nullptr) return ended_;
  if (source_ != &model) return "monitor: it does not listen to data of this model";
  if (heard_) {
    const double ticks = (data.time - *heard_) / design().sample_time();
    if (ticks >= 0.0 && ticks < 1.0 - kSameTime) return nullptr;
    if (!(std::abs(ticks - 1.0) <= kSameTime)) {
      return End(
          "monitor: its run has ended, for mjData.time has not moved by a control "
          "tick; "
          "expected a call in every one, or a restart");
    }
  }
  heard_ = data.time;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    outputs_[i] = data.sensordata[sensors_[i]];
  }
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    inputs_[i] = data.ctrl[actuators_[i]];
  }
  return Take(&model, outputs_, inputs_);
}

const std::string& Watch::Conclude() {
  if (result_) return verdict_;
  const Eigen::Index ticks = monitor().samples();
  if (ticks == 0) throw InputError("monitor", "no ticks", "a run to conclude");
  if (ticks > room_) {
    throw InputError(
        "monitor",
        std::to_string(ticks) + " ticks, opened with room for " + std::to_string(room_),
        "room for the whole run");
  }
  if (ended_ == nullptr) End("monitor: its run is concluded; expected a restart");
  if (!finished_) recording_->Finish();
  finished_ = true;
  DiagnosisResult result = mjdiag::Conclude(*recording_);
  verdict_ = DiagnosisVerdict(result);
  result_ = std::move(result);
  return verdict_;
}

std::string Watch::Json() const {
  if (!result_) {
    throw InputError("monitor", "its run is not concluded", "a conclusion first");
  }
  return DiagnosisJson(*result_);
}

}  // namespace mjdiag
