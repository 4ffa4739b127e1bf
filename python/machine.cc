// Machine: a model with all that is around it, and what it is.

#include "python/machine.h"

#include <pybind11/stl.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/signals/error.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/record.h"
#include "python/work.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

MachineObject MakeMachine(const py::object& setup, const py::object& plant,
                          const py::object& set) {
  MachineSource source = SourceOf(setup, plant, set);
  const Machine machine(ReadSetup(source.setup, source.overrides));
  for (const PlacedEffect& effect : machine.effects()) {
    CheckEffect(machine.plant(), effect);
  }
  return {std::move(source), machine};
}

MachineObject WithEffect(const MachineObject& machine, const std::string& effect,
                         const py::kwargs& values) {
  const std::size_t at = effect.find('@');
  if (at == effect.npos || effect.find(':') != effect.npos) {
    if (values.empty()) return machine.WithEffect(ParseEffect(effect));
    throw InputError("effect '" + effect + "'", "no <effect>@<site>",
                     "for example coulomb_friction@X");
  }
  return machine.WithEffect(Place(effect.substr(0, at), effect.substr(at + 1),
                                  NumbersOf(values, "effect " + effect)));
}

Record ReadFor(const MachineObject& machine, const py::object& path) {
  const MeasuredFile file = MeasuredOf(machine.setup(), path, "Machine.read");
  Warn(file.notes);
  return file.record;
}

/// What was read beside a setup says no more than the numbers.
py::object CalibrationOf(const MachineObject& machine) {
  const std::optional<Calibration>& known = machine.setup().calibration;
  if (!known) return py::none();
  const std::optional<CalibrationReport>& report = machine.calibration();
  const py::module_ package = py::module_::import("mjdiag");
  py::dict numbers;
  const Eigen::VectorXd sd = known->Sd();
  for (std::size_t i = 0; i < known->numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    numbers[known->numbers[i].c_str()] = package.attr("CalibratedNumber")(
        known->factors[at], sd[at],
        report ? py::object(py::float_(report->prior_sd[at])) : py::none());
  }
  py::list nis;
  py::list doubts;
  if (report) {
    for (const CalibratedRecord& record : report->records) {
      nis.append(record.nis);
    }
    for (const std::string& name : report->doubts) doubts.append(name);
  }
  return package.attr("Calibration")(numbers, Copy(known->sensor_noise),
                                     known->force_noise, nis, doubts);
}

std::vector<std::string> TrajectoriesOf(const MachineObject& machine) {
  std::vector<std::string> names;
  for (const Trajectory& one : machine.setup().trajectories.all) {
    names.push_back(one.name);
  }
  return names;
}

std::vector<std::string> FaultNamesOf(const MachineObject& machine) {
  std::vector<std::string> names;
  for (const FaultParameter& one : FaultParameters(machine.machine().plant())) {
    names.push_back(one.name);
  }
  for (const MultisineSetup& one : machine.setup().disturbances) {
    names.push_back(one.name);
  }
  return names;
}

std::vector<std::string> EffectsOf(const MachineObject& machine) {
  std::vector<std::string> effects;
  for (const PlacedEffect& effect : machine.machine().effects()) {
    effects.push_back(FormatEffect(effect));
  }
  return effects;
}

using MachineClass = py::class_<MachineObject>;

void BindDescription(MachineClass& machine) {
  machine
      .def_property_readonly(
          "name", [](const MachineObject& object) { return object.setup().name; },
          "Name of the setup.")
      .def_property_readonly(
          "sample_time",
          [](const MachineObject& object) { return object.setup().rates.tick(); },
          "The control tick [s].")
      .def_property_readonly(
          "sensors",
          [](const MachineObject& object) {
            return ChannelsOf(object.setup().channels.sensors);
          },
          "Names of the sensor channels.")
      .def_property_readonly(
          "actuators",
          [](const MachineObject& object) {
            return ChannelsOf(object.setup().channels.actuators);
          },
          "Names of the actuator channels.")
      .def_property_readonly("trajectories", &TrajectoriesOf,
                             "Names of the trajectories of the setup.")
      .def_property_readonly("fault_names", &FaultNamesOf,
                             "Fault parameters of the plant, and disturbances.")
      .def_property_readonly(
          "effects", &EffectsOf,
          "Effects that act in it, \"<effect>@<site>:<name>=<value>\".")
      .def_property_readonly(
          "faults",
          [](const MachineObject& object) {
            std::map<std::string, double> values = object.disturbances();
            for (const Fault& fault : object.machine().changes().faults) {
              values[fault.name] = fault.value;
            }
            return values;
          },
          "Name -> value of what was set, or found by a discovery.")
      .def_property_readonly(
          "calibration", &CalibrationOf,
          "What healthy runs said, a named tuple Calibration; None without.")
      .def("__repr__", [](const MachineObject& object) {
        return "<mjdiag.Machine " + object.setup().name + ": " + Described(object) +
               ">";
      });
}

}  // namespace

void BindMachine(py::module_& module) {
  MachineClass machine(module, "Machine",
                       R"(
      A machine: a MuJoCo model with its fault parameters, and the setup around it. It
      does not change; with_faults and with_effect make others, cheaply.)");
  machine
      .def(py::init(&MakeMachine), py::arg("setup"), py::arg("plant") = py::none(),
           py::arg("set") = py::none(),
           R"(
          setup: a folder with setup.toml, or a setup file (docs/setup.md); or an MJCF
          file (*.xml) or MJCF as text, whose position and velocity sensors and
          actuators become the channels of a setup with one control tick a time step.
          plant: MJCF, path or text, in the place of that of the setup.
          set: key -> value over what the setup says, {"physics.gravity": False}.
          InputError says file, line and key.)")
      .def(
          "with_faults",
          [](const MachineObject& object, const py::kwargs& values) {
            return object.WithFaults(NumbersOf(values, "fault"));
          },
          R"(
          with_faults(zeta_x=1.2): the machine with fault parameters at those values (1:
          healthy), and disturbances of the setup at those magnitudes (0: healthy).
          InputError lists the names that there are.)")
      .def("with_effect", &WithEffect, py::arg("effect"),
           R"(
           with_effect("coulomb_friction@X", force=2): the machine with physics that the
           plant lacks, <effect>@<site> with its parameters in SI units, or
           <effect>@<site>:<name>=<value>,... (docs/effects.md). InputError.)")
      .def("read", &ReadFor, py::arg("path"),
           R"(
           A measured file, CSV, JSON, HDF5 or MAT, as a Record of this machine: columns as [record]
           of the setup says, on the grid of the control tick; what is missing is marked
           as not measured. What was done is said in warnings. InputError.)");
  machine.def(
      "write",
      [](const MachineObject& object, const py::object& folder) {
        return object.Write(PathOf(folder, "Machine.write")).string();
      },
      py::arg("folder"),
      R"(
      Makes a folder that is a setup, for Machine and for the command: with the faults,
      effects and numbers that were put in, its plant.xml also for any MuJoCo viewer; or
      what `calibrate` learned, with filters and limits. Returns the path of the MJCF, or
      of the calibrated setup.

      InputError: a machine with disturbances, which are part of its runs; the folder of
      the setup itself; a calibrated one with other changes.)");
  BindDescription(machine);
  BindMachineWork(machine);
  BindMachineDesign(machine);
}

}  // namespace mjdiag::python
