#include "python/work.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/discovery/comparison/observed_joints.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/report/tolerance_json.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"
#include "python/arrays.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

ControlMode ModeOf(const std::string& name) {
  if (name == "both") return ControlMode::kBoth;
  if (name == "feedback") return ControlMode::kFeedback;
  if (name == "feedforward") return ControlMode::kFeedforward;
  throw InputError("mode", "'" + name + "'", "both, feedback or feedforward");
}

Excitation ExcitationOf(const Setup& setup, const RunRequest& request) {
  const double duration = request.duration.value_or(0.0);
  if (request.duration && !(duration > 0.0 && std::isfinite(duration))) {
    throw InputError("duration", FormatNumber(duration) + " s", "a time above 0");
  }
  if (request.replay != nullptr) {
    if (!request.trajectory.empty()) {
      throw InputError("simulate", "a trajectory and a record to replay",
                       "one of them");
    }
    const Record& record = *request.replay;
    if (!request.duration) return Replay(setup, record);
    const auto wanted =
        static_cast<Eigen::Index>(std::max(1.0, duration / record.sample_time() + 0.5));
    return Replay(setup, record.Slice(0, std::min(wanted, record.samples())));
  }
  if (setup.control.axes.empty()) {
    throw InputError("simulate", "'" + setup.name + "' has no controlled axes",
                     "replay=, a record with its inputs");
  }
  Trajectory trajectory = setup.trajectories.Find(
      request.trajectory.empty() ? setup.trajectories.fallback : request.trajectory);
  if (request.duration) trajectory.duration = duration;
  return FollowTrajectory(setup, trajectory);
}

RunOptions OptionsOf(const MachineObject& object, const RunRequest& request) {
  RunOptions options;
  options.mode = ModeOf(request.mode);
  CheckMode(object.setup().control, options.mode);
  if (!(request.noise >= 0.0 && std::isfinite(request.noise))) {
    throw InputError("noise", FormatNumber(request.noise), "a factor of 0 or more");
  }
  options.noise_scale = request.noise;
  options.seed = request.seed;
  options.log_joints = request.log_joints;
  options.disturbances = object.disturbances();
  for (const LateFault& late : request.late_faults) {
    if (!(late.time >= 0.0 && std::isfinite(late.time))) {
      throw InputError("late fault " + late.fault.name, "appears at no time of a run",
                       "0 s or later");
    }
    // Complains of names and values that there are not.
    if (!IsDisturbance(object.setup(), late.fault.name)) {
      object.machine().With({{late.fault}, {}});
    }
    options.late_faults.push_back(late);
  }
  return options;
}

Record RunOnce(const Machine& machine, const Excitation& excitation, RunOptions options,
               bool linear, LongCall& call, const std::string& what) {
  options.progress = call.Teller(what);
  return linear ? SimulateLinear(machine, excitation, options)
                : Simulate(machine, excitation, options);
}

struct TitledRecord {
  std::string title;
  Record record;
};

/// Of a measurement, which has encoders but no joints, the joints are estimated.
Record WithJoints(const Machine& machine, Record record) {
  const bool logged = std::ranges::any_of(
      record.channels(),
      [](const Channel& channel) { return channel.name.starts_with("joint."); });
  return logged ? std::move(record) : WithObservedJoints(machine, record);
}

std::vector<TitledRecord> RunsOf(const MachineObject& machine,
                                 const MachineObject* other, const Record* record,
                                 const RunRequest& request, LongCall& call) {
  RunRequest with_joints = request;
  with_joints.log_joints = true;
  if (record != nullptr) with_joints.replay = record;
  const Excitation excitation = ExcitationOf(machine.setup(), with_joints);
  const auto run = [&](const MachineObject& object, const std::string& what) {
    return TitledRecord{Described(object), RunOnce(object.machine(), excitation,
                                                   OptionsOf(object, with_joints),
                                                   request.linear, call, what)};
  };
  std::vector<TitledRecord> runs;
  runs.push_back(run(machine, "simulating"));
  if (other != nullptr) runs.push_back(run(*other, "simulating the other"));
  if (record != nullptr) {
    runs.push_back({"record", WithJoints(machine.machine(), *record)});
  }
  return runs;
}

/// What corrects the one is given to the controllers of the other.
void RequireSameAxes(const Setup& healthy, const Setup& worn) {
  const auto names = [](const Setup& setup) {
    return NamesOf(setup.control.axes, &AxisSetup::name);
  };
  if (names(healthy) == names(worn)) return;
  throw InputError("tolerate", "'" + worn.name + "' has other axes",
                   "'" + healthy.name + "' with faults and effects");
}

/// The records of a manifest, which tells what was set in each; none if it is no manifest.
Measurements Listed(const MachineObject& object, const py::object& records,
                    const py::object& data) {
  const bool is_manifest =
      IsPath(records) && PathOf(records, "record").extension() == ".toml";
  if (is_manifest == data.is_none()) {
    throw InputError("data", is_manifest ? "is missing" : "goes with a manifest only",
                     "a list of records in TOML, with the folder of their files");
  }
  if (!is_manifest) return {};
  return ReadMeasurements(
      object.machine(), object.source().setup, object.source().overrides,
      ReadRecordManifest(PathOf(records, "record"), PathOf(data, "data")));
}

}  // namespace

std::string Described(const MachineObject& machine) {
  const auto& [faults, effects, numbers] = machine.machine().changes();
  std::string text;
  const auto append = [&text](const std::string& item) {
    text += (text.empty() ? "" : ", ") + item;
  };
  for (const Fault& fault : faults) {
    append(fault.name + " = " + Digits(fault.value));
  }
  for (const auto& [name, magnitude] : machine.disturbances()) {
    append(name + " = " + Digits(magnitude));
  }
  for (const PlacedEffect& effect : effects) {
    append(effect.name() + " at " + effect.site);
  }
  return text.empty() ? "healthy" : text;
}

std::vector<LateFault> LateFaultsOf(const GivenLateFaults& given) {
  std::vector<LateFault> late;
  late.reserve(given.size());
  for (const auto& [name, value, time] : given) late.push_back({{name, value}, time});
  return late;
}

const Record* ReplayOf(const py::object& replay) {
  if (replay.is_none()) return nullptr;
  if (py::isinstance<Record>(replay)) return py::cast<const Record*>(replay);
  throw InputError("replay", KindOf(replay),
                   "an mjdiag.Record; Machine.read makes one of a file");
}

Record SimulateMachine(const MachineObject& object, const RunRequest& request,
                       const py::object& progress) {
  const Excitation excitation = ExcitationOf(object.setup(), request);
  const RunOptions options = OptionsOf(object, request);
  Record record;
  RunLong(progress, false, [&](LongCall& call) {
    record = RunOnce(object.machine(), excitation, options, request.linear, call,
                     "simulating");
  });
  return record;
}

ClipSummary RenderMachine(const MachineObject& object, const py::object& other,
                          const py::object& path, const RunRequest& request,
                          ClipOptions options, const py::object& progress) {
  const std::filesystem::path file = PathOf(path, "render");
  const bool is_machine = py::isinstance<MachineObject>(other);
  const bool is_record = py::isinstance<Record>(other);
  if (!is_machine && !is_record && !other.is_none()) {
    throw InputError("render", KindOf(other),
                     "an mjdiag.Machine, an mjdiag.Record or None");
  }
  const auto* second = is_machine ? py::cast<const MachineObject*>(other) : nullptr;
  const auto* record = is_record ? py::cast<const Record*>(other) : nullptr;
  CheckPicture(object.machine().plant(), options.picture);
  ClipSummary summary;
  RunLong(progress, false, [&](LongCall& call) {
    const std::vector<TitledRecord> titled =
        RunsOf(object, second, record, request, call);
    std::vector<ClipRun> runs;
    runs.reserve(titled.size());
    for (const TitledRecord& run : titled) runs.push_back({run.title, &run.record});
    options.progress = call.Teller("rendering");
    summary = RenderClip(object.machine().plant(), runs, options, file);
  });
  return summary;
}

MachineObject CalibrateMachine(const MachineObject& object, const py::object& records,
                               bool linear, const py::object& progress) {
  object.RequireQuiet("calibrate");
  std::vector<Record> healthy;
  for (MeasuredFile& file : AllMeasured(object.setup(), records, "calibrate")) {
    Warn(file.notes);
    healthy.push_back(std::move(file.record));
  }
  if (healthy.empty()) throw InputError("calibrate", "no records", "one or more");
  std::optional<MachineObject> made;
  RunLong(progress, false, [&](LongCall& call) {
    CalibrateOptions options{linear, call.Teller("calibrating")};
    const CalibrationReport report = Calibrate(object.machine(), healthy, options);
    const Machine calibrated = CalibratedMachine(object.machine(), report.calibration);
    NominalRuns nominal;
    nominal.linear = linear;
    nominal.progress = call.Teller("healthy runs");
    PreparedDiagnosis prepared;
    prepared.design = CalibratedFilters(calibrated, healthy, nominal);
    prepared.nominal.linear = linear;
    made = object.WithCalibration(report, calibrated, std::move(prepared));
  });
  return *made;
}

DiscoveryObject DiscoverCauses(const MachineObject& object, const py::object& records,
                               const py::object& data, const py::object& validation,
                               DiscoverOptions options, std::optional<bool> doubt,
                               const py::object& progress) {
  object.RequireQuiet("discover");
  const Machine& machine = object.machine();
  Measurements measurements = Listed(object, records, data);
  const auto take = [&](const py::object& given, const char* what,
                        std::vector<MeasuredRecord>& into) {
    for (MeasuredFile& file : AllMeasured(object.setup(), given, what)) {
      const std::string name = what + (" " + std::to_string(into.size() + 1));
      into.push_back({std::move(file.record), machine, name, std::move(file.notes)});
    }
  };
  if (measurements.fit.empty()) take(records, "record", measurements.fit);
  take(validation, "validation", measurements.unseen);
  if (measurements.fit.empty()) {
    throw InputError("discover", "no records", "one or more");
  }
  if (!(options.budget > 0.0)) {
    throw InputError("budget", FormatNumber(options.budget) + " s", "more than 0");
  }
  options.doubt = doubt.value_or(!IsExact(machine.plant()));
  DiscoveryObject made{object, {}};
  RunLong(progress, true, [&](LongCall& call) {
    options.stop = [&call] { return call.IsStopped(); };
    options.progress = [&call](const DiscoveryProgress& news) {
      call.Tell(news.fraction,
                news.best.empty() ? news.what : news.what + "; so far: " + news.best);
    };
    made.discovery = Discover(machine, measurements, options);
  });
  return made;
}

TolerantRunObject TolerateMachine(const MachineObject& object, const py::object& worn,
                                  const RunRequest& request,
                                  const DiagnoseRequest& diagnosis,
                                  const py::object& progress) {
  object.RequireQuiet("tolerate");
  if (!worn.is_none() && !py::isinstance<MachineObject>(worn)) {
    throw InputError("tolerate", KindOf(worn), "an mjdiag.Machine or None");
  }
  const MachineObject& runs =
      worn.is_none() ? object : py::cast<const MachineObject&>(worn);
  RequireSameAxes(object.setup(), runs.setup());
  const Excitation motion = ExcitationOf(object.setup(), request);
  const RunOptions options = OptionsOf(runs, request);
  TolerantRunObject made;
  for (const AxisSetup& axis : object.setup().control.axes) {
    made.axes.push_back(axis.name);
  }
  RunLong(progress, false, [&](LongCall& call) {
    made.plan = PlanTolerance(object.machine(), options.mode);
    made.prepared = PreparedFor(
        object, diagnosis, [&] { return motion; }, call);
    RequireSameMachine("tolerate", made.prepared->design, runs.setup());
    made.run = RunTolerantly(object.machine(), *made.prepared, made.plan,
                             motion.samples(), options, [&](const RunOptions& with) {
                               return RunOnce(runs.machine(), motion, with,
                                              request.linear, call, "simulating");
                             });
    made.json = ToleranceJson(made.run, made.plan, object.setup()).dump();
  });
  return made;
}

}  // namespace mjdiag::python
