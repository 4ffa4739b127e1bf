#include "mjdiag/report/excitation_page.h"

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

Table Limits(const Machine& machine, const MotionDesign& design) {
  Table table{{{"axis", false}, {"", false}, {"limit", true}, {"this motion", true}},
              {}};
  for (std::size_t i = 0; i < design.limits.size(); ++i) {
    for (const auto& [name, limit] : kAxisLimits) {
      table.rows.push_back({machine.setup().control.axes[i].name, name,
                            FormatNumber(design.limits[i].*limit, 4),
                            FormatNumber(design.peaks[i].*limit, 4)});
    }
  }
  return table;
}

Table Tones(const MotionDesign& design) {
  Table table{{{"axis", false}, {"frequency [Hz]", true}, {"amplitude", true}}, {}};
  for (const ReferenceTone& tone : design.trajectory.tones) {
    table.rows.push_back(
        {tone.axis, FormatNumber(tone.frequency, 4), FormatNumber(tone.amplitude, 4)});
  }
  return table;
}

TimePlot Readings(const std::string& channel, const MotionDesign& design) {
  const Channel& after = design.run_after.At(channel);
  TimePlot plot{.caption = "Reading of " + channel,
                .quantity = channel,
                .unit = after.unit,
                .sample_time = design.run_after.sample_time(),
                .curves = {},
                .bands = {},
                .levels = {},
                .marks = {}};
  plot.curves = {
      {"default motion", CurveRole::kMeasured, design.run_before.At(channel).samples},
      {"this motion", CurveRole::kSimulated, after.samples}};
  return plot;
}

}  // namespace

Table DeviationTable(const MotionDesign& design) {
  Table table{{{"unknown", false},
               {"standard deviation, default motion", true},
               {"this motion", true},
               {"times smaller", true},
               {"wanted", false}},
              {}};
  for (std::size_t i = 0; i < design.unknowns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    table.rows.push_back({design.unknowns[i], FormatNumber(design.before[at], 3),
                          FormatNumber(design.after[at], 3),
                          FormatNumber(design.before[at] / design.after[at], 3),
                          design.wanted[i] ? "yes" : ""});
  }
  return table;
}

std::string GainText(const MotionDesign& design) {
  std::string names;
  for (std::size_t i = 0; i < design.unknowns.size(); ++i) {
    if (design.wanted[i]) names += (names.empty() ? "" : ", ") + design.unknowns[i];
  }
  const bool several = names.find(',') != std::string::npos;
  return std::string("The ") + (several ? "largest " : "") + "standard deviation of " +
         names + " is " + FormatNumber(design.Gain(), 3) +
         " times smaller than with the default motion.";
}

Page ExcitationPage(const Machine& machine, const MotionDesign& design,
                    const RunDescription& run) {
  Page page("A motion that tells more, " + machine.setup().name);
  page.SetVerdict(design.Gain() > 1.0 ? Tone::kGood : Tone::kNeutral, GainText(design));
  page.AddHeading("What it tells");
  page.AddParagraph(
      "Standard deviations that no estimator is better than, of the linear machine, "
      "all "
      "unknown together.");
  page.AddTable(DeviationTable(design));
  page.AddHeading("The motion");
  if (!design.moves_of.empty()) {
    page.AddParagraph("The moves of trajectory " + design.moves_of + ", " +
                      FormatNumber(design.share_of_moves, 3) +
                      " times as far, and tones.");
  }
  page.AddTable(Tones(design));
  for (const AxisSetup& axis : machine.setup().control.axes) {
    page.AddPlot(Readings(axis.sensor, design));
  }
  page.AddHeading("Its limits");
  page.AddParagraph("Peaks of the nonlinear machine without noise, in SI units.");
  page.AddTable(Limits(machine, design));
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
