// MotionDesign: a motion within the limits of the axes that tells most.

#include "python/excitation.h"

#include <pybind11/stl.h>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "mjdiag/report/excitation_json.h"
#include "mjdiag/report/excitation_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

std::vector<std::string> NamesIn(const py::object& names, const std::string& what) {
  if (py::isinstance<py::str>(names)) return {py::cast<std::string>(names)};
  std::vector<std::string> all;
  if (!py::hasattr(names, "__iter__")) {
    throw InputError(what, KindOf(names), "a name or a list of names");
  }
  for (const py::handle name : names) {
    if (!py::isinstance<py::str>(name)) {
      throw InputError(what, KindOf(name) + " among the names", "a str");
    }
    all.push_back(py::cast<std::string>(name));
  }
  return all;
}

AxisLimits LimitsOf(const std::map<std::string, double>& given,
                    const std::string& what) {
  AxisLimits limits;
  for (const auto& [name, number] : given) {
    double* limit = FindLimit(limits, name);
    if (limit == nullptr) {
      std::string known;
      for (const auto& [one, member] : kAxisLimits) {
        known += (known.empty() ? "" : ", ") + std::string(one);
      }
      throw InputError(what, "there is no '" + name + "'", known);
    }
    if (!std::isfinite(number)) {
      throw InputError(what, "'" + name + "' is not finite", "a finite number");
    }
    *limit = number;
  }
  return limits;
}

}  // namespace

std::map<std::string, AxisLimits> LimitsByAxis(const py::object& given) {
  std::map<std::string, AxisLimits> limits;
  if (given.is_none()) return limits;
  const char* expected = "a dict of dicts, {\"x\": {\"velocity\": 0.3}}";
  if (!py::isinstance<py::dict>(given)) {
    throw InputError("limits", KindOf(given), expected);
  }
  for (const auto& [axis, own] : py::reinterpret_borrow<py::dict>(given)) {
    const std::string name = py::str(axis);
    const std::string what = "limits of '" + name + "'";
    if (!py::isinstance<py::dict>(own)) throw InputError(what, KindOf(own), expected);
    limits[name] =
        LimitsOf(NumbersOf(py::reinterpret_borrow<py::kwargs>(own), what), what);
  }
  return limits;
}

py::dict LimitDict(const std::vector<std::string>& names,
                   const std::vector<AxisLimits>& all) {
  py::dict axes;
  for (std::size_t i = 0; i < all.size(); ++i) {
    py::dict own;
    for (const auto& [name, limit] : kAxisLimits) {
      if (std::isfinite(all[i].*limit)) own[name] = all[i].*limit;
    }
    axes[names[i].c_str()] = own;
  }
  return axes;
}

void RequirePositive(const char* what, double value, const char* unit) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw InputError(what, FormatNumber(value) + " " + unit, "more than 0");
}

MotionDesignObject ExciteMachine(const MachineObject& object, const py::object& wanted,
                                 const py::object& limits,
                                 std::optional<double> max_frequency,
                                 const std::string& name, std::optional<double> budget,
                                 const py::object& progress) {
  object.RequireQuiet("excite");
  MotionDesignOptions options;
  options.wanted = NamesIn(wanted, "wanted");
  options.limits = LimitsByAxis(limits);
  if (max_frequency) RequirePositive("max_frequency", *max_frequency, "Hz");
  options.highest_frequency = max_frequency.value_or(0.0);
  options.name = name;
  if (budget) RequirePositive("budget", *budget, "s");
  for (const Trajectory& trajectory : object.setup().trajectories.all) {
    if (trajectory.name != name) continue;
    throw InputError("name", "there is a trajectory '" + name + "' already",
                     "another name");
  }
  MotionDesignObject made{object, {}};
  RunLong(progress, true, [&](LongCall& call) {
    options.stop = call.StopAfter(budget);
    options.progress = [&](double fraction, double gain) {
      call.Tell(fraction, gain > 1.0 ? "motions; so far: sd " + FormatNumber(gain, 3) +
                                           " times smaller"
                                     : "motions");
    };
    made.design = DesignMotion(object.machine(), options);
  });
  return made;
}

namespace {

std::vector<std::string> AxesOf(const MotionDesignObject& object) {
  std::vector<std::string> names;
  for (const AxisSetup& axis : object.machine.setup().control.axes)
    names.push_back(axis.name);
  return names;
}

py::list TonesOf(const MotionDesignObject& object) {
  const py::object make = py::module_::import("mjdiag").attr("Tone");
  py::list tones;
  for (const ReferenceTone& tone : object.design.trajectory.tones) {
    tones.append(make(tone.axis, tone.frequency, tone.amplitude, tone.phase));
  }
  return tones;
}

py::array WantedOf(const MotionDesignObject& object) {
  const std::vector<bool>& wanted = object.design.wanted;
  SampleMask mask(std::ssize(wanted));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    mask[static_cast<Eigen::Index>(i)] = wanted[i];
  }
  return Copy(mask);
}

py::object DeviationFrame(const MotionDesignObject& object) {
  py::dict columns;
  columns["sd_before"] = Copy(object.design.before);
  columns["sd_after"] = Copy(object.design.after);
  columns["wanted"] = WantedOf(object);
  return Library("pandas", "MotionDesign.to_pandas")
      .attr("DataFrame")(columns, py::arg("index") = object.design.unknowns);
}

std::string MotionDesignHtml(const MotionDesignObject& object) {
  Page page(object.machine.setup().name);
  page.SetVerdict(object.design.Gain() > 1.0 ? Tone::kGood : Tone::kNeutral,
                  GainText(object.design));
  page.AddTable(DeviationTable(object.design));
  return NotebookHtml(page);
}

void ReportMotion(const MotionDesignObject& object, const py::object& path) {
  WriteReportFile(
      ExcitationPage(object.machine.machine(), object.design,
                     {"machine.excite()", "", {{"mjdiag", MJDIAG_VERSION}}}),
      path);
}

using MotionClass = py::class_<MotionDesignObject>;

void BindMotion(MotionClass& design) {
  design
      .def_property_readonly(
          "name",
          [](const MotionDesignObject& object) {
            return object.design.trajectory.name;
          },
          "Of the trajectory.")
      .def_property_readonly(
          "duration",
          [](const MotionDesignObject& object) {
            return object.design.trajectory.duration;
          },
          "Of the motion, that of the default one [s].")
      .def_property_readonly("tones", &TonesOf,
                             R"(
          List of Tone: axis, frequency [Hz], amplitude [unit of the axis], phase [rad].)")
      .def_property_readonly(
          "moves_of",
          [](const MotionDesignObject& object) -> py::object {
            if (object.design.moves_of.empty()) return py::none();
            return py::str(object.design.moves_of);
          },
          "The trajectory whose moves these are; None: tones alone.")
      .def_property_readonly(
          "share_of_moves",
          [](const MotionDesignObject& object) { return object.design.share_of_moves; },
          "How far the moves go, as times of that trajectory.")
      .def_property_readonly(
          "limits",
          [](const MotionDesignObject& object) {
            return LimitDict(AxesOf(object), object.design.limits);
          },
          R"(
          Axis -> dict with lowest, highest [m or rad], velocity, acceleration, jerk, snap
          and force [N or N m] that it had to keep to.)")
      .def_property_readonly(
          "peaks",
          [](const MotionDesignObject& object) {
            return LimitDict(AxesOf(object), object.design.peaks);
          },
          "The same of what it does in the nonlinear machine without noise.")
      .def_property_readonly(
          "run_before",
          [](const MotionDesignObject& object) { return object.design.run_before; },
          "The default motion in the nonlinear machine without noise, a Record.")
      .def_property_readonly(
          "run_after",
          [](const MotionDesignObject& object) { return object.design.run_after; },
          "This motion in the nonlinear machine without noise, a Record.");
}

void BindWhatItTells(MotionClass& design) {
  design
      .def_property_readonly(
          "gain", [](const MotionDesignObject& object) { return object.design.Gain(); },
          R"(
          Of what was wanted, the largest standard deviation with the default motion over
          that with this one.)")
      .def_property_readonly(
          "unknowns",
          [](const MotionDesignObject& object) { return object.design.unknowns; },
          "Names of all that is unknown together, what was wanted among them.")
      .def_property_readonly("wanted", &WantedOf,
                             "Whether it was wanted, (unknowns,) of bool.")
      .def_property_readonly(
          "sd_before",
          [](const py::object& self) {
            return View(py::cast<const MotionDesignObject&>(self).design.before, self);
          },
          R"(
          Standard deviations that no estimator is better than, with the default motion,
          (unknowns,).)")
      .def_property_readonly(
          "sd_after",
          [](const py::object& self) {
            return View(py::cast<const MotionDesignObject&>(self).design.after, self);
          },
          "The same with this motion, as long as that, (unknowns,).")
      .def("to_pandas", &DeviationFrame,
           R"(
           sd_before, sd_after and wanted -> pandas.DataFrame, a row for every unknown.
           ImportError without pandas.)")
      .def_property_readonly(
          "verdict",
          [](const MotionDesignObject& object) { return GainText(object.design); },
          "The answer in one sentence.")
      .def_property_readonly(
          "stopped",
          [](const MotionDesignObject& object) { return object.design.stopped; },
          R"(
          Whether budget or Ctrl-C ended it before everything was tried; it is then the
          best motion so far.)");
}

}  // namespace

void BindExcitation(py::module_& module) {
  MotionClass design(module, "MotionDesign",
                     R"(
                     The answer of Machine.excite: a motion within the limits of the axes
                     that tells most, and what it tells. In a notebook it shows that.)");
  BindMotion(design);
  BindWhatItTells(design);
  design
      .def_property_readonly(
          "machine",
          [](const MotionDesignObject& object) {
            return object.machine.Following(object.design.trajectory);
          },
          "The Machine with this motion as its default one, ready to simulate.")
      .def(
          "write",
          [](const MotionDesignObject& object, const py::object& folder) {
            return object.machine
                .WriteFollowing(PathOf(folder, "MotionDesign.write"),
                                object.design.trajectory)
                .string();
          },
          py::arg("folder"),
          R"(
          Makes a folder with the setup of the machine, and this motion as its default one,
          as the command does. Returns the path of setup.toml.

          InputError: the folder of the setup itself; a machine that is not as its files
          have it, which machine.write is for.)")
      .def(
          "to_dict",
          [](const MotionDesignObject& object) {
            return ParsedJson(ToJson(object.machine.machine(), object.design).dump());
          },
          "All of it as a dict, schema \"mjdiag.excitation/1\".")
      .def("report", &ReportMotion, py::arg("path"),
           "Writes one self-contained HTML page. InputError if that cannot be written.")
      .def("_repr_html_", &MotionDesignHtml)
      .def("__repr__", [](const MotionDesignObject& object) {
        return "<mjdiag.MotionDesign: " + GainText(object.design) + ">";
      });
}

}  // namespace mjdiag::python
