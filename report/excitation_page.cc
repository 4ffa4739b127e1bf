#include "mjdiag/report/excitation_page.h"

#include <cmath>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

Table Tones(const MotionDesign& design) {
  Table table{{{"axis", false}, {"frequency [Hz]", true}, {"amplitude", true}}, {}};
  for (const ReferenceTone& tone : design.trajectory.tones) {
    table.rows.push_back(
        {tone.axis, FormatNumber(tone.frequency, 4), FormatNumber(tone.amplitude, 4)});
  }
  return table;
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

Table LimitTable(const std::string& kind, const std::vector<std::string>& names,
                 const std::vector<AxisLimits>& limits,
                 const std::vector<AxisLimits>& peaks) {
  Table table{{{kind, false}, {"", false}, {"limit", true}, {"this motion", true}}, {}};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    for (const auto& [name, limit] : kAxisLimits) {
      if (!std::isfinite(limits[i].*limit)) continue;
      table.rows.push_back({names[i], name, FormatNumber(limits[i].*limit, 4),
                            FormatNumber(peaks[i].*limit, 4)});
    }
  }
  return table;
}

TimePlot BesidePlot(const std::string& what, const Channel& before,
                    const std::string& beside, const Channel& after,
                    double sample_time) {
  TimePlot plot{.caption = what + " of " + after.name,
                .quantity = after.name,
                .unit = after.unit,
                .sample_time = sample_time,
                .curves = {},
                .bands = {},
                .levels = {},
                .marks = {}};
  plot.curves = {{beside, CurveRole::kMeasured, before.samples},
                 {"this motion", CurveRole::kSimulated, after.samples}};
  return plot;
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
  std::vector<std::string> axes;
  for (const AxisSetup& axis : machine.setup().control.axes) {
    axes.push_back(axis.name);
    page.AddPlot(BesidePlot("Reading", design.run_before.At(axis.sensor),
                            "default motion", design.run_after.At(axis.sensor),
                            design.run_after.sample_time()));
  }
  page.AddHeading("Its limits");
  page.AddParagraph("Peaks of the nonlinear machine without noise, in SI units.");
  page.AddTable(LimitTable("axis", axes, design.limits, design.peaks));
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
