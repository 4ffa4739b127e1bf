#pragma once
// What an answer says of masses and of where they are, together (mass_moments.h).

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/found_members.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Discovery::moments, of the hinges whose moment the numbers of the answer change:
///
///   var S = g^T V g,     g = dS / dx, V of the coordinates x of the answer;
///
/// beforehand the same of all numbers that were in doubt.
void AddMoments(const AnswerData& data, const ModelOnRuns& answer,
                const CoordinateErrors& errors, Discovery& discovery);

}  // namespace mjdiag
