// Comparison: what a simulation gets wrong on a measured record.

#include "python/comparison.h"

#include <utility>

#include "mjdiag/report/comparison_fields.h"
#include "mjdiag/report/comparison_json.h"
#include "mjdiag/report/comparison_page.h"
#include "mjdiag/signals/quantity.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/fields.h"

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

}  // namespace

void BindComparison(py::module_& module) {
  py::class_<ChannelMismatch> mismatch(module, "Mismatch",
                                       R"(
                              Measured less simulated of a channel, in its unit; of a
                              machine that falls, less what was predicted over a tick.)");
  BindFields<ChannelMismatch>(mismatch).def(
      "__repr__", [](const ChannelMismatch& channel) {
        return "<mjdiag.Mismatch: " + channel.name + " " +
               FormatQuantity(channel.rms, channel.unit) + " rms, noise floor " +
               FormatQuantity(channel.noise_floor.rms, channel.unit) + ">";
      });
  py::class_<DisturbanceEstimate> disturbance(
      module, "DisturbanceEstimate", "The force that the model lacks at a joint.");
  BindFields<DisturbanceEstimate>(disturbance)
      .def_property_readonly(
          "value",
          [](const py::object& self) {
            return View(py::cast<const DisturbanceEstimate&>(self).value, self);
          },
          "Of every sample, (samples,) [unit].")
      .def("__repr__", [](const DisturbanceEstimate& force) {
        return "<mjdiag.DisturbanceEstimate: " + force.joint + " " +
               FormatQuantity(force.rms, force.unit) + " rms, known to " +
               FormatQuantity(force.sd, force.unit) + ">";
      });
  py::class_<ComparisonObject> comparison(module, "Comparison",
                                          R"(
                             The answer of Machine.compare: what the simulation gets wrong
                             on a measured record. In a notebook it shows its verdict and
                             tables.)");
  BindFields<Comparison>(comparison, &ComparisonObject::comparison)
      .def_readonly("notes", &ComparisonObject::notes,
                    "What one should know of how a file became the record.")
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
