#pragma once
// How small a fault is seen beside the plant as given and beside the extended one
// (fault_limits.h), by the innovations of the filter of each with its noise.

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Of all fault parameters that the plant declares.
void AddFaultLimits(const AnswerData& data, const UnseenJudgement& judged,
                    Discovery& discovery);

}  // namespace mjdiag
