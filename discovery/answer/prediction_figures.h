#pragma once
// Mismatch of a machine of which no free simulation says anything: how far predictions over a
// short time are off (discovery/comparison/prediction.h), from where the filter of each plant
// has the machine, before and after.

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Mismatch per channel over the longest horizon of 0.1 s at most that none diverges in, the
/// noise of the readings as floor, and the gains. Behind AddReplays, whose figures it
/// replaces.
void AddPredictions(const AnswerData& data, const UnseenJudgement& judged,
                    Discovery& discovery);

}  // namespace mjdiag
