#pragma once
// What a better model is for: how small a fault can be seen on the measured machine, beside
// the plant as given and beside the extended one. The response phi of the innovations of the
// filter to a fault parameter is known to first order. A healthy machine whose model is wrong
// already looks like a fault of size
//
//   theta = phi^T e / phi^T phi,
//
// and differently so from one part of the record to the next. A fault that is smaller
// than |theta| + 3 sd(theta), sd from the parts, is hidden by that.

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Of all fault parameters that the plant declares.
void AddMinimumDetectableFaults(const AnswerData& data, const UnseenJudgement& judged,
                                Discovery& discovery);

}  // namespace mjdiag
