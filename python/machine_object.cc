#include <algorithm>
#include <utility>

#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/error.h"
#include "python/arrays.h"
#include "python/machine.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

std::shared_ptr<const PreparedDiagnosis> PreparedCache::For(const Machine& machine,
                                                            bool linear,
                                                            LongCall& call) {
  const std::lock_guard lock(mutex_);
  auto& made = made_[linear];
  if (!made) {
    DiagnosisSource source;
    source.nominal.linear = linear;
    source.nominal.progress = call.Teller("healthy runs");
    made = std::make_shared<PreparedDiagnosis>(PrepareDiagnosis(machine, source));
  }
  return made;
}

void PreparedCache::Keep(PreparedDiagnosis prepared) {
  const std::lock_guard lock(mutex_);
  const bool linear = prepared.nominal.linear;
  made_[linear] = std::make_shared<PreparedDiagnosis>(std::move(prepared));
}

std::shared_ptr<const PreparedDiagnosis> PreparedCache::Kept() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [linear, prepared] : made_) {
    if (prepared) return prepared;
  }
  return nullptr;
}

MachineObject MachineObject::Changed(Changes changes) const {
  MachineObject changed = *this;
  changed.machine_ = nominal_.With(changes);
  changed.changes_ = std::move(changes);
  changed.prepared_ = std::make_shared<PreparedCache>();
  return changed;
}

MachineObject MachineObject::WithFaults(
    const std::map<std::string, double>& values) const {
  Changes changes = changes_;
  std::map<std::string, double> disturbances = disturbances_;
  for (const auto& [name, value] : values) {
    if (IsDisturbance(setup(), name)) {
      disturbances[name] = value;
      continue;
    }
    const auto same = std::ranges::find(changes.faults, name, &Fault::name);
    if (same == changes.faults.end()) {
      changes.faults.push_back({name, value});
    } else {
      same->value = value;
    }
  }
  MachineObject changed = changes == changes_ ? *this : Changed(std::move(changes));
  changed.disturbances_ = std::move(disturbances);
  return changed;
}

MachineObject MachineObject::WithEffect(const PlacedEffect& effect) const {
  CheckEffect(machine_.plant(), effect);
  Changes changes = changes_;
  changes.effects.push_back(effect);
  return Changed(std::move(changes));
}

MachineObject MachineObject::WithCalibration(const CalibrationReport& report,
                                             const Machine& calibrated,
                                             PreparedDiagnosis prepared) const {
  MachineObject changed = *this;
  changed.nominal_ = changed.machine_ = calibrated;
  changed.changes_ = {};
  changed.prepared_ = std::make_shared<PreparedCache>();
  changed.calibration_ = report;
  changed.prepared_->Keep(std::move(prepared));
  return changed;
}

MachineObject MachineObject::Extended(const Changes& changes, int substeps) const {
  MachineObject extended = *this;
  extended.nominal_ = machine_.WithSubsteps(substeps).With(changes);
  extended.machine_ = extended.nominal_;
  extended.changes_ = {};
  extended.prepared_ = std::make_shared<PreparedCache>();
  return extended;
}

MachineObject MachineObject::Following(const Trajectory& trajectory) const {
  MachineObject following = *this;
  for (Machine* machine :
       {&following.original_, &following.nominal_, &following.machine_}) {
    Setup setup = machine->setup();
    setup.trajectories.all.push_back(trajectory);
    setup.trajectories.fallback = trajectory.name;
    *machine = machine->WithSetup(std::move(setup));
  }
  following.followed_.push_back(trajectory);
  following.prepared_ = std::make_shared<PreparedCache>();
  return following;
}

std::filesystem::path MachineObject::SetupFor(const std::filesystem::path& folder,
                                              Folders& made) const {
  std::filesystem::path setup = source_.setup;
  if (!followed_.empty()) FileForOther(setup, folder);
  for (const Trajectory& trajectory : followed_) {
    made.push_back(std::make_unique<ScratchFolder>());
    WriteSetupFollowing(made.back()->path(), setup, trajectory);
    setup = made.back()->path();
  }
  return setup;
}

std::filesystem::path MachineObject::WriteFollowing(
    const std::filesystem::path& folder, const Trajectory& trajectory) const {
  if (machine_.changes() != Changes{} || !source_.overrides.empty() || calibration_) {
    throw InputError("MotionDesign.write",
                     "of a machine that is not as its files have it",
                     "one without faults, effects, keys that were set and calibration; "
                     "or MotionDesign.machine.write");
  }
  Folders made;
  WriteSetupFollowing(folder, SetupFor(folder, made), trajectory);
  return folder / "setup.toml";
}

std::filesystem::path MachineObject::Write(const std::filesystem::path& folder) const {
  RequireQuiet("Machine.write");
  Folders made;
  if (!calibration_) {
    return WriteExtendedSetup(folder, SetupFor(folder, made),
                              original_.WithSubsteps(machine_.rates().substeps),
                              machine_.changes());
  }
  if (machine_.changes() != Changes{} || !source_.overrides.empty()) {
    throw InputError("Machine.write",
                     "a calibrated machine that is not as its files have it",
                     "one without faults, effects and keys that were set");
  }
  const auto prepared = prepared_->Kept();
  WriteCalibratedSetup(folder, SetupFor(folder, made), calibration_->calibration,
                       prepared->design);
  return folder / "setup.toml";
}

void MachineObject::RequireQuiet(const std::string& what) const {
  if (disturbances_.empty()) return;
  throw InputError(what,
                   "the machine has the disturbance " + disturbances_.begin()->first,
                   "a machine without; they are part of its runs");
}

MeasuredFile MeasuredOf(const Setup& setup, py::handle record,
                        const std::string& what) {
  if (py::isinstance<Record>(record)) {
    return WithoutRepeats(py::cast<const Record&>(record), ReadingsOf(setup));
  }
  if (!IsPath(record)) {
    throw InputError(what, KindOf(record),
                     "an mjdiag.Record or the path of a measured file");
  }
  return ReadMeasured(setup, PathOf(record, what));
}

std::vector<MeasuredFile> AllMeasured(const Setup& setup, const py::object& records,
                                      const std::string& what) {
  std::vector<MeasuredFile> all;
  if (records.is_none()) return all;
  const bool is_one = py::isinstance<Record>(records) || IsPath(records);
  if (!is_one && !py::hasattr(records, "__iter__")) {
    throw InputError(what, KindOf(records), "a list of records");
  }
  if (is_one) {
    all.push_back(MeasuredOf(setup, records, what));
  } else {
    for (const py::handle record : records) {
      all.push_back(MeasuredOf(setup, record, what));
    }
  }
  return all;
}

}  // namespace mjdiag::python
