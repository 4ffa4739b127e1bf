#pragma once
// The page of `mjdiag excite`: what a motion tells, beside the default one.

#include "mjdiag/report/page/page.h"
#include "mjdiag/studies/excitation/motion_design.h"

namespace mjdiag {

/// "The largest standard deviation of beta_x becomes 3.2 times smaller."
std::string GainText(const MotionDesign& design);

/// Of every unknown, with either motion.
Table DeviationTable(const MotionDesign& design);

/// Of every axis or joint the limits that there are, and what a motion comes to.
/// @param kind  "axis" or "joint"
Table LimitTable(const std::string& kind, const std::vector<std::string>& names,
                 const std::vector<AxisLimits>& limits,
                 const std::vector<AxisLimits>& peaks);
/// Where something goes, in a motion and in the one beside which that was designed.
/// @param beside  what that is called
TimePlot BesidePlot(const std::string& what, const Channel& before,
                    const std::string& beside, const Channel& after,
                    double sample_time);

/// The whole page.
Page ExcitationPage(const Machine& machine, const MotionDesign& design,
                    const RunDescription& run);

}  // namespace mjdiag
