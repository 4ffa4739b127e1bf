#pragma once
// The page of `mjdiag excite` for a machine without controllers: how well a motion tells its
// numbers apart, beside the measured one.

#include "mjdiag/report/page/page.h"
#include "mjdiag/studies/excitation/joint_motion_design.h"

namespace mjdiag {

/// "The condition number of what the motion tells is 34, that of the measured ..."
std::string ConditionText(const JointMotionDesign& design);
/// "54 numbers can be told apart; 37 others only together with those."
std::string ToldText(const JointMotionDesign& design);

/// Standard deviations of all numbers with both motions.
Table NumberTable(const JointMotionDesign& design);

/// The whole page.
Page JointExcitationPage(const Machine& machine, const JointMotionDesign& design,
                         const RunDescription& run);

}  // namespace mjdiag
