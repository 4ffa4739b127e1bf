// Comparison: what a simulation gets wrong on a measured record.

#include "python/comparison.h"

#include <pybind11/stl.h>

#include <utility>

#include "mjdiag/report/comparison_json.h"
#include "mjdiag/report/comparison_page.h"
#include "mjdiag/signals/quantity.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"

namespace mjdiag::python {

namespace py = pybind11;

ComparisonObject CompareRecord(const MachineObject& object, const py::object& record,
                               bool open_loop, std::uint64_t seed,
                               const py::object& progress) {
  MeasuredFile measured = MeasuredOf(object.setup(), record, "compare");
  const Machine machine =
      open_loop ? object.machine().WithSetup(WithoutControllers(object.setup()))
                : object.machine();
  ComparisonObject made{{}, std::move(measured.notes)};
  RunLong(progress, false, [&](LongCall& call) {
    RunOptions options;
    options.disturbances = object.disturbances();
    options.seed = seed;
    options.progress = call.Teller("comparing");
    made.comparison = Compare(machine, measured.record, options);
  });
  return made;
}

namespace {

std::string ComparisonHtml(const ComparisonObject& object) {
  const Comparison& comparison = object.comparison;
  Page page(comparison.setup);
  page.SetVerdict(comparison.exceeds_noise() ? Tone::kBad : Tone::kGood,
                  ComparisonVerdict(comparison));
  if (!comparison.falls) {
    page.AddTable(ChannelTable(comparison));
    if (!comparison.derived.empty()) page.AddTable(DerivedTable(comparison));
  }
  if (comparison.deviance) {
    page.AddTable(PredictionTable(comparison));
    page.AddTable(DisturbanceTable(comparison));
  }
  for (const std::string& note : object.notes) page.AddParagraph(note);
  return NotebookHtml(page);
}

void ReportComparison(const ComparisonObject& object, const py::object& path) {
  WriteReportFile(ComparisonPage(object.comparison, {"machine.compare(record)",
                                                     "an mjdiag.Record",
                                                     {{"mjdiag", MJDIAG_VERSION}}}),
                  path);
}

py::dict MismatchesOf(const ComparisonObject& object) {
  py::dict channels;
  for (const ChannelMismatch& channel : object.comparison.channels) {
    channels[channel.name.c_str()] = channel;
  }
  return channels;
}

py::dict DerivedOf(const ComparisonObject& object) {
  py::dict derived;
  for (const DerivedMismatch& one : object.comparison.derived) {
    derived[one.name.c_str()] = one.relative_error_percent;
  }
  return derived;
}

py::dict PredictionOf(const ComparisonObject& object) {
  py::dict prediction;
  for (const Prediction::Sensor& sensor : object.comparison.prediction.sensors) {
    prediction[sensor.channel.c_str()] = Copy(sensor.rms);
  }
  return prediction;
}

py::dict DisturbancesOf(const ComparisonObject& object) {
  py::dict forces;
  for (const DisturbanceEstimate& force : object.comparison.missing_force) {
    forces[force.joint.c_str()] = force;
  }
  return forces;
}

void BindMismatch(py::module_& module) {
  py::class_<ChannelMismatch>(module, "Mismatch",
                              R"(
                              Measured less simulated of a channel, in its unit; of a
                              machine that falls, less what was predicted over a tick.)")
      .def_readonly("name", &ChannelMismatch::name, "Of the channel.")
      .def_readonly("unit", &ChannelMismatch::unit, "SI.")
      .def_readonly("rms", &ChannelMismatch::rms, "Root of the mean square.")
      .def_readonly("mae", &ChannelMismatch::mae, "Mean magnitude.")
      .def_readonly("peak", &ChannelMismatch::peak, "Largest magnitude.")
      .def_readonly("fit_percent", &ChannelMismatch::fit_percent,
                    R"(
          100: nothing is wrong; 0: the mean of what was measured would do as well;
          negative, down to -inf, beyond.)")
      .def_readonly("relative_error_percent", &ChannelMismatch::relative_error_percent,
                    "100 ||measured - simulated|| / ||measured||; may be inf.")
      .def_property_readonly(
          "noise_floor",
          [](const ChannelMismatch& channel) { return channel.noise_floor.rms; },
          "The rms if noise were all there is.")
      .def_readonly("exceeds_noise", &ChannelMismatch::exceeds_noise,
                    "Whether there is more than noise.")
      .def_readonly("p_value", &ChannelMismatch::p_value,
                    "Chance that noise alone reaches this rms.")
      .def_property_readonly(
          "worst_window",
          [](const ChannelMismatch& channel) {
            const WorstWindow& worst = channel.worst;
            return py::make_tuple(worst.start, worst.duration, worst.rms);
          },
          "Where it is largest: (start [s], duration [s], rms).")
      .def("__repr__", [](const ChannelMismatch& channel) {
        return "<mjdiag.Mismatch: " + channel.name + " " +
               FormatQuantity(channel.rms, channel.unit) + " rms, noise floor " +
               FormatQuantity(channel.noise_floor.rms, channel.unit) + ">";
      });
}

void BindDisturbance(py::module_& module) {
  py::class_<DisturbanceEstimate>(module, "DisturbanceEstimate",
                                  "The force that the model lacks at a joint.")
      .def_readonly("joint", &DisturbanceEstimate::joint, "Its name.")
      .def_readonly("unit", &DisturbanceEstimate::unit, R"("N" or "N m".)")
      .def_property_readonly(
          "value",
          [](const py::object& self) {
            return View(py::cast<const DisturbanceEstimate&>(self).value, self);
          },
          "Of every sample, (samples,) [unit].")
      .def_readonly("rms", &DisturbanceEstimate::rms, "Of value [unit].")
      .def_readonly("sd", &DisturbanceEstimate::sd,
                    "Standard deviation of its error [unit].")
      .def_readonly("memory", &DisturbanceEstimate::memory, "How long it lasts [s].")
      .def("__repr__", [](const DisturbanceEstimate& force) {
        return "<mjdiag.DisturbanceEstimate: " + force.joint + " " +
               FormatQuantity(force.rms, force.unit) + " rms, known to " +
               FormatQuantity(force.sd, force.unit) + ">";
      });
}

using ComparisonClass = py::class_<ComparisonObject>;

/// What the filter says that follows the motion.
void BindFollowed(ComparisonClass& comparison) {
  comparison
      .def_property_readonly(
          "falls",
          [](const ComparisonObject& object) { return object.comparison.falls; },
          R"(
          Whether the machine does not stay with the measurement when its inputs alone
          drive it. Channels are then what a filter that follows the motion predicts from
          one tick to the next, and derived is empty.)")
      .def_property_readonly(
          "horizons",
          [](const ComparisonObject& object) {
            const std::vector<double>& all = object.comparison.prediction.horizons;
            return Copy(
                Eigen::VectorXd(Eigen::VectorXd::Map(all.data(), std::ssize(all))));
          },
          "How far ahead it predicts, (horizons,) [s].")
      .def_property_readonly("prediction", &PredictionOf,
                             R"(
          Sensor channel -> rms of the error over every horizon, (horizons,), in the unit
          of the channel; inf where a prediction diverges.)")
      .def_property_readonly("missing_force", &DisturbancesOf,
                             "Joint -> DisturbanceEstimate.")
      .def_property_readonly(
          "deviance",
          [](const ComparisonObject& object) -> py::object {
            if (!object.comparison.deviance) return py::none();
            return py::float_(*object.comparison.deviance);
          },
          R"(
          -2 ln L of the filter that follows the motion: of two models of one record the one
          with the lower is more probable. None where the record lacks sensors or commands;
          prediction and missing_force are then empty.)");
}

}  // namespace

void BindComparison(py::module_& module) {
  BindMismatch(module);
  BindDisturbance(module);
  ComparisonClass comparison(module, "Comparison",
                             R"(
                             The answer of Machine.compare: what the simulation gets wrong
                             on a measured record. In a notebook it shows its verdict and
                             tables.)");
  comparison
      .def_property_readonly(
          "verdict",
          [](const ComparisonObject& object) {
            return ComparisonVerdict(object.comparison);
          },
          "The answer in one sentence.")
      .def_property_readonly(
          "exceeds_noise",
          [](const ComparisonObject& object) {
            return object.comparison.exceeds_noise();
          },
          "Whether any channel has more than noise.")
      .def_property_readonly(
          "closed_loop",
          [](const ComparisonObject& object) { return object.comparison.closed_loop; },
          "Whether the measured reference was followed; else the inputs were applied.")
      .def_property_readonly(
          "channels", &MismatchesOf,
          "Name -> Mismatch of sensors and, in closed loop, actuators.")
      .def_property_readonly("derived", &DerivedOf,
                             R"(
          Name -> relative error [%] of velocities, accelerations and forces; may be inf.)")
      .def_property_readonly(
          "measured",
          [](const ComparisonObject& object) { return object.comparison.measured; },
          "Record of the channels as they were measured.")
      .def_property_readonly(
          "simulated",
          [](const ComparisonObject& object) { return object.comparison.simulated; },
          "Record of the same channels as they were simulated, without noise.")
      .def_property_readonly(
          "not_measured",
          [](const ComparisonObject& object) { return object.comparison.not_measured; },
          "Names of channels that the record lacks.")
      .def_readonly("notes", &ComparisonObject::notes,
                    "What one should know of how a file became the record.");
  BindFollowed(comparison);
  comparison
      .def(
          "to_dict",
          [](const ComparisonObject& object) {
            return ParsedJson(ToJson(object.comparison).dump());
          },
          "All figures as a dict, schema \"mjdiag.compare/1\"; None where one is inf.")
      .def("report", &ReportComparison, py::arg("path"),
           "Writes one self-contained HTML page. InputError if that cannot be written.")
      .def("_repr_html_", &ComparisonHtml)
      .def("__repr__", [](const ComparisonObject& object) {
        return "<mjdiag.Comparison: " + ComparisonVerdict(object.comparison) + ">";
      });
}

}  // namespace mjdiag::python
