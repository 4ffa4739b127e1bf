#pragma once
// Which members of an answer do so little at every joint that nobody would miss them
// (negligible.h): by what the machine does otherwise without each in every tick.

#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"

namespace mjdiag {

/// Of every member.
std::vector<bool> NobodyWouldMiss(const AnswerData& data, const ModelOnRuns& answer);

}  // namespace mjdiag
