// mjdiag compare: what the simulation gets wrong on a measured record.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "app/command.h"
#include "app/format.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/subject.h"
#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/report/comparison_fields.h"
#include "mjdiag/report/comparison_json.h"
#include "mjdiag/report/comparison_page.h"
#include "mjdiag/report/field_reference.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {
namespace {

struct CompareOptions {
  MachineOptions machine;
  OutputOptions output;
  std::string record;
  std::uint64_t seed = 1;
  bool open_loop = false;
};

std::string ChannelText(const Comparison& comparison) {
  Table table({"channel", "rms mismatch", "mean absolute", "fit", "relative error",
               "noise floor", "above noise", "worst window"});
  for (const ChannelMismatch& channel : comparison.channels) {
    table.Add({channel.name, FormatQuantity(channel.rms, channel.unit),
               FormatQuantity(channel.mae, channel.unit),
               Short(channel.fit_percent) + " %",
               Short(channel.relative_error_percent) + " %",
               FormatQuantity(channel.noise_floor.rms, channel.unit),
               channel.exceeds_noise ? "yes" : "no",
               FormatQuantity(channel.worst.rms, channel.unit) + " at " +
                   Short(channel.worst.start) + " s"});
  }
  return table.ToString();
}

std::string DerivedText(const Comparison& comparison) {
  if (comparison.derived.empty()) return "";
  Table table({"derived", "relative error"});
  for (const DerivedMismatch& derived : comparison.derived) {
    table.Add({derived.name, Short(derived.relative_error_percent) + " %"});
  }
  return "\n" + table.ToString();
}

/// Errors of predictions, and forces that are missing.
std::string FollowedText(const Comparison& comparison) {
  if (!comparison.deviance) return "";
  const Prediction& prediction = comparison.prediction;
  std::vector<std::string> columns = {"prediction error, rms"};
  for (const double horizon : prediction.horizons) {
    columns.push_back("over " + FormatQuantity(horizon, "s"));
  }
  Table ahead(columns);
  for (const Prediction::Sensor& sensor : prediction.sensors) {
    std::vector<std::string> row = {sensor.channel};
    for (const double rms : sensor.rms) {
      row.push_back(std::isfinite(rms) ? FormatQuantity(rms, sensor.unit) : "diverges");
    }
    ahead.Add(row);
  }
  Table forces({"joint", "missing force, rms", "known to", "lasts"});
  for (const DisturbanceEstimate& force : comparison.missing_force) {
    forces.Add({force.joint, FormatQuantity(force.rms, force.unit),
                FormatQuantity(force.sd, force.unit),
                FormatQuantity(force.memory, "s")});
  }
  return "\n" + ahead.ToString() + "\n" + forces.ToString() + "\n-2 ln L " +
         Short(*comparison.deviance) + "\n";
}

void Compare(CompareOptions& options) {
  std::vector<std::string> notes = DraftMachine(options.machine, options.record);
  std::ranges::copy(AdoptClock(options.machine, options.record),
                    std::back_inserter(notes));
  Subject subject = LoadSubject(options.machine);
  subject.options.seed = options.seed;
  std::ranges::copy(NotesOn(subject.nominal), std::back_inserter(notes));
  const Record measured = ReadMeasured(subject.setup(), options.record, notes);
  if (options.open_loop) {
    subject.machine =
        subject.machine.WithSetup(WithoutControllers(subject.machine.setup()));
  }
  PrepareOutput(options.output);
  Comparison comparison;
  {
    ProgressBar bar("comparing");
    subject.options.progress = bar.Shower();
    comparison = Compare(subject.machine, measured, subject.options);
  }

  nlohmann::json document = ToJson(comparison);
  document.update(ToJson(subject));
  document["record"] = options.record;
  document["command"] = CommandLine();
  std::string text =
      ComparisonVerdict(comparison) + "\n\n" +
      (comparison.falls ? std::string()
                        : ChannelText(comparison) + DerivedText(comparison)) +
      FollowedText(comparison);
  AddNotes(notes, document, text);
  const RunDescription run{CommandLine(), options.record, {{"mjdiag", MJDIAG_VERSION}}};
  Publish(options.output, "compare", document, text, [&] {
    NamedPage page{"compare", ComparisonPage(comparison, run)};
    AddNotes(notes, page.page);
    return page;
  });
}

}  // namespace

void AddCompare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand(
      "compare", "What the simulation gets wrong on a measured record");
  AddMachineOrPlantOptions(*command, options->machine);
  command
      ->add_option("--record", options->record,
                   "Measured record: CSV, JSON, HDF5 or MAT")
      ->required();
  command->add_flag(
      "--open-loop", options->open_loop,
      "Drive the actuators with the measured signals, whatever controllers "
      "the setup has");
  AddSeedOption(*command, options->seed, "Seed of the noise floor's simulation");
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  AddFieldsOption(*command, &FieldReference<Comparison>);
  command->callback([options] { Compare(*options); });
}

}  // namespace mjdiag::app
