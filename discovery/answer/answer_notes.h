#pragma once
// Notes on an answer: what cannot be judged, what is not told apart and which experiment
// would, numbers that are far from what anyone expects, and sensors that are noisier than the
// setup says.

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// @param may_go_on  whether there is time for experiments
void AddNotes(const AnswerData& data, const UnseenJudgement& judged,
              const std::function<bool()>& may_go_on, Discovery& discovery);

/// White noise of sensors beyond what the setup says of them, as causes. Only where nothing
/// else is left: what a model lacks may look like noise.
void AddRaisedNoise(const AnswerData& data, const ModelOnRuns& answer,
                    const CandidateChoice& choice, Discovery& discovery);

}  // namespace mjdiag
