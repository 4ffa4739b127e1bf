#pragma once
// The page of `mjdiag excite`: what a motion tells, beside the default one.

#include "mjdiag/report/page/page.h"
#include "mjdiag/studies/excitation/motion_design.h"

namespace mjdiag {

/// "The largest standard deviation of beta_x becomes 3.2 times smaller."
std::string GainText(const MotionDesign& design);

/// Of every unknown, with either motion.
Table DeviationTable(const MotionDesign& design);

/// The whole page.
Page ExcitationPage(const Machine& machine, const MotionDesign& design,
                    const RunDescription& run);

}  // namespace mjdiag
