// JointMotionDesign: a motion of an arm that tells most, beside a measured one.

#include "python/joint_excitation.h"

#include <pybind11/stl.h>

#include <utility>

#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/report/excitation_json.h"
#include "mjdiag/report/joint_excitation_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/excitation.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

JointMotionObject ExciteJoints(const MachineObject& object, const py::object& record,
                               const py::object& limits,
                               std::optional<double> max_frequency,
                               std::optional<double> budget,
                               const py::object& progress) {
  object.RequireQuiet("excite_joints");
  JointMotionOptions options;
  options.limits = LimitsByAxis(limits);
  if (max_frequency) RequirePositive("max_frequency", *max_frequency, "Hz");
  options.highest_frequency = max_frequency.value_or(0.0);
  if (budget) RequirePositive("budget", *budget, "s");
  const MeasuredFile measured = MeasuredOf(object.setup(), record, "excite_joints");
  JointMotionObject made{object, {}, measured.notes};
  RunLong(progress, true, [&](LongCall& call) {
    options.stop = call.StopAfter(budget);
    options.progress = [&](double fraction, double condition) {
      call.Tell(fraction,
                "motions; so far: condition number " + FormatNumber(condition, 3));
    };
    made.design = DesignJointMotion(
        object.machine(), ToMeasuredRun(object.setup(), measured.record), options);
  });
  return made;
}

namespace {

using JointMotionClass = py::class_<JointMotionObject>;

/// A member that is an array, seen and not copied.
template <typename Member>
auto ViewOf(Member member) {
  return [member](const py::object& self) {
    return View(py::cast<const JointMotionObject&>(self).design.*member, self);
  };
}

/// A member that Python has a type of its own for.
template <typename Member>
auto ValueOf(Member member) {
  return [member](const JointMotionObject& object) { return object.design.*member; };
}

py::object NumberFrame(const JointMotionObject& object) {
  py::dict columns;
  columns["unit"] = object.design.units;
  columns["sd_before"] = Copy(object.design.before);
  columns["sd_after"] = Copy(object.design.after);
  return Library("pandas", "JointMotionDesign.to_pandas")
      .attr("DataFrame")(columns, py::arg("index") = object.design.numbers);
}

std::string JointMotionHtml(const JointMotionObject& object) {
  Page page(object.machine.setup().name);
  page.SetVerdict(object.design.Gain() > 1.0 ? Tone::kGood : Tone::kNeutral,
                  ConditionText(object.design));
  page.AddTable(NumberTable(object.design));
  return NotebookHtml(page);
}

void BindJointNumbers(JointMotionClass& design) {
  design
      .def_property_readonly("numbers", ValueOf(&JointMotionDesign::numbers), R"(
          Names of what any motion tells: "mass@link3", "moment_x@link3",
          "inertia_xy@link3", "armature@joint3", "damping@joint3",
          "friction@joint3".)")
      .def_property_readonly("units", ValueOf(&JointMotionDesign::units),
                             "Of every number, a list of str.")
      .def_property_readonly("untold", ValueOf(&JointMotionDesign::untold),
                             "How many others show only together with those.")
      .def_property_readonly(
          "sd_before", ViewOf(&JointMotionDesign::before),
          "Standard deviations with the measured motion, (numbers,).")
      .def_property_readonly("sd_after", ViewOf(&JointMotionDesign::after),
                             "The same with this motion, (numbers,).")
      .def_property_readonly("condition_before",
                             ValueOf(&JointMotionDesign::condition_before),
                             "Condition number of what the measured motion tells.")
      .def_property_readonly("condition_after",
                             ValueOf(&JointMotionDesign::condition_after),
                             "The same of this motion.")
      .def_property_readonly("noise", ViewOf(&JointMotionDesign::noise), R"(
          What no such numbers explain of the record, rms of every joint [N or N m],
          (joints,).)")
      .def_property_readonly("bandwidth", ValueOf(&JointMotionDesign::bandwidth),
                             "Of the noise [Hz].")
      .def("to_pandas", &NumberFrame, R"(
          unit, sd_before and sd_after -> pandas.DataFrame, a row for every number.
          ImportError without pandas.)");
}

void BindJointPath(JointMotionClass& design) {
  design
      .def_property_readonly("joints", ValueOf(&JointMotionDesign::joints),
                             "Their names.")
      .def_property_readonly(
          "record",
          [](const JointMotionObject& object) { return object.design.Motion(); },
          "Where the joints go at every control tick, a Record [rad or m].")
      .def_property_readonly("position", ViewOf(&JointMotionDesign::position),
                             "The same as an array, (joints, samples).")
      .def_property_readonly("sample_time", ValueOf(&JointMotionDesign::sample_time),
                             "Between two samples [s].")
      .def_property_readonly("highest_frequency",
                             ValueOf(&JointMotionDesign::highest_frequency),
                             "Of the Fourier series [Hz].")
      .def_property_readonly(
          "limits",
          [](const JointMotionObject& object) {
            return LimitDict(object.design.joints, object.design.limits);
          },
          R"(
          Joint -> dict with lowest, highest [m or rad], velocity, acceleration and force
          [N or N m] that it had to keep to.)")
      .def_property_readonly(
          "peaks",
          [](const JointMotionObject& object) {
            return LimitDict(object.design.joints, object.design.peaks);
          },
          "The same of what it does.");
}

}  // namespace

void BindJointExcitation(py::module_& module) {
  JointMotionClass design(module, "JointMotionDesign", R"(
      The answer of Machine.excite_joints: a motion of every joint, and what it tells beside
      the measured one. In a notebook it shows that.)");
  BindJointPath(design);
  BindJointNumbers(design);
  design
      .def_property_readonly(
          "verdict",
          [](const JointMotionObject& object) { return ConditionText(object.design); },
          "The answer in one sentence.")
      .def_property_readonly(
          "notes", [](const JointMotionObject& object) { return object.notes; },
          "What one should know about the record, a list of str.")
      .def_property_readonly("stopped", ValueOf(&JointMotionDesign::stopped), R"(
          Whether budget or Ctrl-C ended it before everything was tried; it is then the
          best motion so far.)")
      .def(
          "to_dict",
          [](const JointMotionObject& object) {
            return ParsedJson(ToJson(object.machine.machine(), object.design).dump());
          },
          "All of it but the path as a dict, schema \"mjdiag.joint_excitation/1\".")
      .def(
          "report",
          [](const JointMotionObject& object, const py::object& path) {
            WriteReportFile(
                JointExcitationPage(
                    object.machine.machine(), object.design,
                    {"machine.excite_joints()", "", {{"mjdiag", MJDIAG_VERSION}}}),
                path);
          },
          py::arg("path"),
          "Writes one self-contained HTML page. InputError if that cannot be written.")
      .def("_repr_html_", &JointMotionHtml)
      .def("__repr__", [](const JointMotionObject& object) {
        return "<mjdiag.JointMotionDesign: " + ConditionText(object.design) + ">";
      });
}

}  // namespace mjdiag::python
