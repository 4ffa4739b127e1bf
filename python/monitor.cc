// Monitor: a diagnosis at work, tick by tick.

#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/signals/error.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/fields.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

bool AllFinite(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

/// A monitor needs one tick after the other: a bad one ends its run.
class MonitorObject {
 public:
  /// @param machine  none: the filters alone, without a twin
  /// @param room     ticks that a conclusion can look back on
  MonitorObject(std::optional<Machine> machine,
                std::shared_ptr<const PreparedDiagnosis> prepared, Eigen::Index room)
      : machine_(std::move(machine)), prepared_(std::move(prepared)), room_(room) {
    Restart();
  }

  const DiagnosisDesign& design() const { return prepared_->design; }
  const DiagnosisMonitor& monitor() const { return recording_->monitor; }

  void Restart() {
    recording_.emplace(machine_ ? BeginDiagnosis(*machine_, *prepared_, room_)
                                : DiagnosisRecording(design(), room_));
    ended_ = nullptr;
    concluded_.reset();
  }

  bool Step(py::handle y, py::handle u) {
    const std::span<const double> outputs = Take(y, design().outputs.size(), 0, "y");
    const std::span<const double> inputs = Take(u, design().inputs.size(), 1, "u");
    if (ended_ == nullptr && !(AllFinite(outputs) && AllFinite(inputs))) {
      ended_ = "its run has ended with a reading or command that is no finite number";
    }
    if (ended_ != nullptr) throw InputError("monitor", ended_, "a restart");
    recording_->Add(outputs, inputs);
    return monitor().residual_alarm();
  }

  DiagnosisObject Conclude() {
    if (concluded_) return *concluded_;
    const Eigen::Index ticks = monitor().samples();
    if (ticks == 0 || ticks > room_) {
      throw InputError(
          "monitor",
          std::to_string(ticks) + " ticks, made with capacity " + std::to_string(room_),
          "a run of 1 to capacity ticks");
    }
    ended_ = "its run is concluded";
    recording_->Finish();
    concluded_ = DiagnosisObject{prepared_, ConcludeWithLog(*recording_), {}};
    return *concluded_;
  }

 private:
  /// The numbers where they lie, or copied if they lie in no such array.
  std::span<const double> Take(py::handle array, std::size_t wanted, std::size_t which,
                               const char* name) {
    std::size_t size = 0;
    const double* data = DataOf(array, &size);
    if (data == nullptr) {
      copies_[which] = VectorOf(array, std::string("monitor: ") + name);
      data = copies_[which].data();
      size = static_cast<std::size_t>(copies_[which].size());
    }
    if (size != wanted) {
      throw InputError(std::string("monitor: ") + name,
                       std::to_string(size) + " values",
                       std::to_string(wanted) + ", one for every channel");
    }
    return {data, size};
  }

  std::optional<Machine> machine_;
  std::shared_ptr<const PreparedDiagnosis> prepared_;
  Eigen::Index room_;
  std::optional<DiagnosisRecording> recording_;
  const char* ended_ = nullptr;  // why no more ticks are taken
  std::optional<DiagnosisObject> concluded_;
  std::array<Eigen::VectorXd, 2> copies_;
};

std::unique_ptr<MonitorObject> MakeMonitor(const std::optional<MachineObject>& machine,
                                           bool linear, const py::object& filters,
                                           Eigen::Index capacity,
                                           const py::object& progress) {
  if (capacity < 0) {
    throw InputError("monitor", "capacity " + std::to_string(capacity), "0 or more");
  }
  if (!machine && filters.is_none()) {
    throw InputError("monitor", "neither a machine nor filters",
                     "at least one of them");
  }
  const std::string file = filters.is_none() ? "" : PathOf(filters, "filters").string();
  if (!machine) {
    auto prepared = std::make_shared<PreparedDiagnosis>();
    prepared->design = ReadFilters(file);
    return std::make_unique<MonitorObject>(std::nullopt, prepared, capacity);
  }
  machine->RequireQuiet("monitor");
  std::unique_ptr<MonitorObject> made;
  RunLong(progress, false, [&](LongCall& call) {
    std::shared_ptr<const PreparedDiagnosis> prepared;
    if (file.empty()) {
      prepared = machine->prepared().For(machine->machine(), linear, call);
    } else {
      DiagnosisSource source;
      source.filters = file;
      source.nominal.linear = linear;
      source.nominal.progress = call.Teller("healthy runs");
      prepared = std::make_shared<PreparedDiagnosis>(
          PrepareDiagnosis(machine->machine(), source));
    }
    made = std::make_unique<MonitorObject>(machine->machine(), prepared, capacity);
  });
  return made;
}

std::optional<double> TimeOf(const MonitorObject& object,
                             const std::optional<Eigen::Index>& tick) {
  if (!tick) return std::nullopt;
  return static_cast<double>(*tick) * object.design().sample_time();
}

py::array_t<double> EstimatesOf(const MonitorObject& object) {
  Eigen::VectorXd values = object.monitor().estimate();
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] += object.design().Healthy(i);
  }
  return Copy(values);
}

Named<FaultVerdict> JudgedFaults(const MonitorObject& object) {
  return NamedBy(JudgeFaults(object.monitor()), &FaultVerdict::name, std::identity());
}

void BindReadings(py::class_<MonitorObject>& monitor) {
  monitor
      .def_property_readonly(
          "ticks",
          [](const MonitorObject& object) { return object.monitor().samples(); },
          "Ticks so far.")
      .def_property_readonly(
          "residual",
          [](const MonitorObject& object) { return object.monitor().residuals()[0]; },
          "The residual of the last tick, in units of its own noise.")
      .def_property_readonly(
          "limits",
          [](const MonitorObject& object) {
            const Interval& limits = object.design().limits.residual.limits;
            return std::pair{limits.min, limits.max};
          },
          "Limits (low, high) of the residual.")
      .def_property_readonly(
          "alarm",
          [](const MonitorObject& object) { return object.monitor().residual_alarm(); },
          "Whether the residual is outside its limits now.")
      .def_property_readonly(
          "lasting_alarm",
          [](const MonitorObject& object) { return object.monitor().lasting_alarm(); },
          "Whether its mean magnitude is: no passing disturbance.")
      .def_property_readonly(
          "first_detection",
          [](const MonitorObject& object) {
            return TimeOf(object, object.monitor().first_detection());
          },
          "When the residual first was outside, since the first tick [s]; None.")
      .def_property_readonly("estimates", &EstimatesOf,
                             R"(
          What the fault parameters are taken for now, in the order of fault_names,
          (faults,).)")
      .def_property_readonly(
          "estimate_sd",
          [](const MonitorObject& object) {
            return Copy(object.monitor().estimate_sd());
          },
          "Their standard deviations, (faults,); NaN as long as there are none.")
      .def_property_readonly("faults", &JudgedFaults,
                             "Name -> Fault, as the machine is judged now.");
}

}  // namespace

void BindMonitor(py::module_& module) {
  py::class_<MonitorObject> monitor(module, "Monitor",
                                    R"(
                                    A diagnosis that runs beside a machine: it gets the
                                    readings and commands of every control tick and can
                                    be asked between ticks what is wrong. One thread at
                                    a time.)");
  monitor
      .def(py::init(&MakeMonitor), py::arg("machine") = py::none(), py::kw_only(),
           py::arg("linear") = false, py::arg("filters") = py::none(),
           py::arg("capacity") = 0, py::arg("progress") = py::none(),
           R"(
          machine: the healthy Machine; None: filters alone, without a twin, and faults
          are told apart less well.
          linear: it is taken as linear, without dry friction.
          filters: filters.json of `mjdiag design`; None: made now, with limits from
          simulated healthy runs, which takes seconds.
          capacity: ticks of the longest run that is to be concluded.
          progress: as of Machine.simulate.

          InputError: filters of another machine, one that cannot be diagnosed.)")
      .def("step", &MonitorObject::Step, py::arg("y"), py::arg("u"),
           R"(
          One control tick: y the readings (outputs,), u the commands (inputs,), in SI
          units and in the order of the channels. Contiguous float64 arrays are not
          copied. Returns alarm. InputError: another length, or a number that is not
          finite, which ends the run.)")
      .def("conclude", &MonitorObject::Conclude,
           "Ends the run: its Diagnosis. InputError for more ticks than capacity.")
      .def("restart", &MonitorObject::Restart, "Makes it ready for another run.")
      .def_property_readonly(
          "outputs",
          [](const MonitorObject& object) { return object.design().outputs; },
          "Names of the channels of y.")
      .def_property_readonly(
          "inputs", [](const MonitorObject& object) { return object.design().inputs; },
          "Names of the channels of u.")
      .def_property_readonly(
          "fault_names",
          [](const MonitorObject& object) { return object.design().FaultNames(); },
          "Names of the fault parameters, then of the disturbances.")
      .def_property_readonly(
          "sample_time",
          [](const MonitorObject& object) { return object.design().sample_time(); },
          "The control tick [s].")
      .def("__repr__", [](const MonitorObject& object) {
        return "<mjdiag.Monitor of " + object.design().setup + ": " +
               std::to_string(object.monitor().samples()) + " ticks, " +
               (object.monitor().residual_alarm() ? "alarm>" : "no alarm>");
      });
  BindReadings(monitor);
}

}  // namespace mjdiag::python
