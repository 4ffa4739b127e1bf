#include "mjdiag/report/comparison_page.h"

#include <limits>

#include "mjdiag/report/mismatch_tables.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

std::string Seconds(double value) { return FormatNumber(value, 4); }

std::string Ratio(const ChannelMismatch& channel) {
  if (channel.rms == 0.0) return "0";
  return FormatNumber(channel.rms / channel.noise_floor.rms);
}

void AddRecordFacts(Page& page, const Comparison& comparison,
                    const RunDescription& run) {
  const Record& record = comparison.measured;
  std::vector<std::pair<std::string, std::string>> facts = {
      {"Setup", comparison.setup},
      {"Record", run.record},
      {"Replayed", comparison.closed_loop ? "measured reference, in closed loop"
                   : comparison.falls
                       ? "measured input, beside a filter that follows the motion"
                       : "measured input, in open loop"},
      {"Length", std::to_string(record.samples()) + " samples at " +
                     FormatQuantity(1.0 / record.sample_time(), "Hz") + ", " +
                     FormatQuantity(record.duration(), "s")},
      {"Left out at the start",
       std::to_string(comparison.options.skip_samples) + " samples"}};
  if (!comparison.not_measured.empty()) {
    facts.emplace_back("Not measured", Listed(comparison.not_measured));
  }
  page.AddFacts(facts);
}

constexpr const char* kHowToRead =
    "Mismatch is measured minus simulated. The noise floor is what the sensor noise "
    "found in the record explains, through the control loop where there is one. Beyond "
    "noise: the mean square of the mismatch is larger than that of the floor, in a "
    "one-sided F test at a level of ";

void AddChannels(Page& page, const Comparison& comparison) {
  page.AddTable(ChannelTable(comparison));
  const double level = 100.0 * comparison.options.level;
  page.AddParagraph(kHowToRead + FormatNumber(level, 1) + " % for each channel.");
}

void AddDerived(Page& page, const Comparison& comparison) {
  if (comparison.derived.empty()) return;
  page.AddHeading("Derived signals");
  page.AddTable(DerivedTable(comparison));
}

void AddFollowed(Page& page, const Comparison& comparison) {
  if (comparison.prediction.sensors.empty()) return;
  page.AddHeading("Prediction");
  page.AddTable(PredictionTable(comparison));
  page.AddParagraph(
      "The plant runs on with the measured inputs alone, from states that a filter "
      "has found from the readings up to then.");
  page.AddHeading("Missing forces");
  for (const DisturbanceEstimate& force : comparison.missing_force) {
    TimePlot plot;
    plot.quantity = force.joint;
    plot.unit = force.unit;
    plot.start_time = comparison.measured.start_time();
    plot.sample_time = comparison.measured.sample_time();
    plot.caption = force.joint + ", force that the plant lacks, " +
                   FormatQuantity(force.rms, force.unit) + " rms";
    plot.curves = {{"missing force", CurveRole::kMismatch, force.value}};
    plot.height = 200;
    page.AddPlot(plot);
  }
}

TimePlot TimeAxis(const Record& record, const Channel& channel) {
  TimePlot plot;
  plot.quantity = channel.name;
  plot.unit = channel.unit;
  plot.start_time = record.start_time();
  plot.sample_time = record.sample_time();
  return plot;
}

Band WorstBand(const ChannelMismatch& channel) {
  return {channel.worst.start, channel.worst.start + channel.worst.duration,
          "worst window"};
}

void AddSignalPlot(Page& page, const Comparison& comparison,
                   const ChannelMismatch& channel) {
  const Channel& measured = comparison.measured.At(channel.name);
  const Channel& simulated = comparison.simulated.At(channel.name);
  TimePlot plot = TimeAxis(comparison.measured, measured);
  plot.caption = channel.name + ", measured and simulated";
  plot.curves = {{"measured", CurveRole::kMeasured, measured.samples},
                 {"simulated", CurveRole::kSimulated, simulated.samples}};
  plot.bands = {WorstBand(channel)};
  page.AddPlot(plot);
}

void AddMismatchPlot(Page& page, const Comparison& comparison,
                     const ChannelMismatch& channel) {
  const Record& measured = comparison.measured;
  TimePlot plot = TimeAxis(measured, measured.At(channel.name));
  plot.caption = channel.name + ", mismatch";
  Eigen::VectorXd mismatch =
      measured.At(channel.name).samples - comparison.simulated.At(channel.name).samples;
  // What the figures leave out must not set the scale of the axis either.
  mismatch.head(comparison.options.skip_samples)
      .setConstant(std::numeric_limits<double>::quiet_NaN());
  if (const SampleMask& counts = measured.At(channel.name).measured;
      counts.size() > 0) {
    mismatch = counts.select(mismatch, std::numeric_limits<double>::quiet_NaN());
  }
  plot.curves = {{"measured - simulated", CurveRole::kMismatch, mismatch}};
  plot.bands = {WorstBand(channel)};
  const double floor = channel.noise_floor.rms;
  plot.levels = {{floor, "noise floor (rms)"}, {-floor, "noise floor (rms)"}};
  plot.height = 200;
  page.AddPlot(plot);
}

void AddMismatchSpectrum(Page& page, const ChannelMismatch& channel) {
  SpectrumPlot plot;
  plot.caption = channel.name + ", spectrum of the mismatch";
  plot.quantity = channel.name;
  plot.unit = channel.unit;
  plot.frequency = channel.spectrum.frequency;
  plot.curves = {
      {"mismatch", CurveRole::kMismatch, channel.spectrum.density.cwiseSqrt()}};
  const Spectrum& noise = channel.noise_floor.spectrum;
  if (noise.density.size() == channel.spectrum.density.size()) {
    plot.curves.push_back(
        {"noise floor", CurveRole::kNoise, noise.density.cwiseSqrt()});
  }
  page.AddPlot(plot);
}

}  // namespace

std::string ComparisonVerdict(const Comparison& comparison) {
  if (comparison.falls && !comparison.missing_force.empty()) {
    std::string forces;
    for (const DisturbanceEstimate& force : comparison.missing_force) {
      forces += (forces.empty() ? "" : ", ") + force.joint + " " +
                FormatQuantity(force.rms, force.unit);
    }
    return "Driven by its inputs alone the plant does not stay with the measurement. "
           "Beside it a force is missing (rms): " +
           forces + ".";
  }
  if (!comparison.exceeds_noise()) {
    std::vector<std::string> names;
    for (const ChannelMismatch& channel : comparison.channels) {
      names.push_back(channel.name);
    }
    return "No mismatch beyond the noise floor in " + Listed(names) + ".";
  }
  const ChannelMismatch* worst = comparison.Worst();
  const std::string size = FormatQuantity(worst->rms, worst->unit) + " rms, " +
                           PercentText(worst->relative_error_percent);
  if (worst->noise_floor.rms == 0.0) {
    return "The simulation misses " + worst->name + ", which is free of noise (" +
           size + ").";
  }
  return "The mismatch of " + worst->name + " is " + Ratio(*worst) +
         " times its noise floor (" + size + ").";
}

Table ChannelTable(const Comparison& comparison) {
  Table table;
  table.columns = {{"Channel"},
                   {"Mismatch, rms", true},
                   {"Mean absolute", true},
                   {"Fit", true},
                   {"Peak", true},
                   {"Relative error", true},
                   {"Noise floor", true},
                   {"Times the floor", true},
                   {"Beyond noise"},
                   {"Worst window", true},
                   {"Its rms", true}};
  for (const ChannelMismatch& channel : comparison.channels) {
    const WorstWindow& worst = channel.worst;
    const std::string end = Seconds(worst.start + worst.duration) + " s";
    table.rows.push_back(
        {channel.name, FormatQuantity(channel.rms, channel.unit),
         FormatQuantity(channel.mae, channel.unit), PercentText(channel.fit_percent),
         FormatQuantity(channel.peak, channel.unit),
         PercentText(channel.relative_error_percent),
         FormatQuantity(channel.noise_floor.rms, channel.unit), Ratio(channel),
         channel.exceeds_noise ? "yes" : "no", Seconds(worst.start) + " to " + end,
         FormatQuantity(worst.rms, channel.unit)});
  }
  return table;
}

Table DerivedTable(const Comparison& comparison) {
  Table table;
  table.columns = {{"Signal"}, {"Mismatch, rms", true}, {"Relative error", true}};
  for (const DerivedMismatch& derived : comparison.derived) {
    table.rows.push_back({derived.name, FormatQuantity(derived.rms, derived.unit),
                          PercentText(derived.relative_error_percent)});
  }
  return table;
}

Table PredictionTable(const Comparison& comparison) {
  const Prediction& prediction = comparison.prediction;
  Table ahead;
  ahead.columns = {{"Channel"}};
  for (const double horizon : prediction.horizons) {
    ahead.columns.push_back(
        {"Error over " + FormatQuantity(horizon, "s") + ", rms", true});
  }
  for (const Prediction::Sensor& sensor : prediction.sensors) {
    std::vector<std::string> row = {sensor.channel};
    for (const double rms : sensor.rms) row.push_back(FormatQuantity(rms, sensor.unit));
    ahead.rows.push_back(row);
  }
  return ahead;
}

Table DisturbanceTable(const Comparison& comparison) {
  Table table;
  table.columns = {
      {"Joint"}, {"Missing force, rms", true}, {"Known to", true}, {"Lasts", true}};
  for (const DisturbanceEstimate& force : comparison.missing_force) {
    table.rows.push_back({force.joint, FormatQuantity(force.rms, force.unit),
                          FormatQuantity(force.sd, force.unit),
                          FormatQuantity(force.memory, "s")});
  }
  return table;
}

Page ComparisonPage(const Comparison& comparison, const RunDescription& run) {
  Page page("Measured against simulated: " + comparison.setup);
  page.SetVerdict(comparison.exceeds_noise() ? Tone::kBad : Tone::kGood,
                  ComparisonVerdict(comparison));
  AddRecordFacts(page, comparison, run);
  AddFollowed(page, comparison);
  page.AddHeading(comparison.falls ? "Channels, predicted over one tick" : "Channels");
  AddChannels(page, comparison);
  AddDerived(page, comparison);
  for (const ChannelMismatch& channel : comparison.channels) {
    page.AddHeading("Channel " + channel.name);
    AddSignalPlot(page, comparison, channel);
    AddMismatchPlot(page, comparison, channel);
    AddMismatchSpectrum(page, channel);
  }
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
