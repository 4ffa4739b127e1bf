#include "mjdiag/report/joint_excitation_page.h"

#include "mjdiag/report/excitation_page.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {

Table NumberTable(const JointMotionDesign& design) {
  Table table{{{"number", false},
               {"standard deviation, measured motion", true},
               {"this motion", true},
               {"times smaller", true}},
              {}};
  for (std::size_t i = 0; i < design.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    table.rows.push_back({design.numbers[i],
                          FormatQuantity(design.before[at], design.units[i]),
                          FormatQuantity(design.after[at], design.units[i]),
                          FormatNumber(design.before[at] / design.after[at], 3)});
  }
  return table;
}

std::string ConditionText(const JointMotionDesign& design) {
  const double smaller =
      std::exp((design.before.array() / design.after.array()).log().mean());
  return "The condition number of what the motion tells is " +
         FormatNumber(design.condition_after, 3) + ", that of the measured motion " +
         FormatNumber(design.condition_before, 3) + "; its standard deviations are " +
         FormatNumber(smaller, 3) + " times smaller on average.";
}

std::string ToldText(const JointMotionDesign& design) {
  return std::to_string(design.numbers.size()) + " numbers can be told apart; " +
         std::to_string(design.untold) + " others only together with those.";
}

Page JointExcitationPage(const Machine& machine, const JointMotionDesign& design,
                         const RunDescription& run) {
  Page page("A motion that tells more, " + machine.setup().name);
  page.SetVerdict(design.Gain() > 1.0 ? Tone::kGood : Tone::kNeutral,
                  ConditionText(design));
  page.AddHeading("What it tells");
  page.AddParagraph(
      ToldText(design) +
      " Standard deviations of the best linear unbiased estimator, with "
      "noise as large as what no such numbers explain of the record, up to " +
      FormatQuantity(design.bandwidth, "Hz") + ".");
  page.AddTable(NumberTable(design));
  page.AddHeading("The motion");
  page.AddParagraph("A Fourier series up to " +
                    FormatQuantity(design.highest_frequency, "Hz") +
                    ", at rest at its begin and end.");
  const Record motion = design.Motion();
  for (std::size_t j = 0; j < design.joints.size(); ++j) {
    const Channel before{design.joints[j], design.joint_units[j],
                         design.position_before.row(static_cast<Eigen::Index>(j))};
    page.AddPlot(BesidePlot("Position", before, "measured motion",
                            motion.At(design.joints[j]), design.sample_time));
  }
  page.AddHeading("Its limits");
  page.AddParagraph("In SI units; forces are those of the plant as it is given.");
  page.AddTable(LimitTable("joint", design.joints, design.limits, design.peaks));
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
