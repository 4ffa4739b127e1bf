#pragma once
// Notes on an answer: what cannot be judged, what is not told apart and which experiment
// would, numbers that are far from what anyone expects, and sensors that are noisier than the
// setup says.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// What looks odd in records, and which numbers of the plant are never in doubt. InputError
/// on what cannot be judged (data_check.h).
/// @param doubt  whether numbers are in doubt at all
std::vector<std::string> NotesOfChecks(const mjModel& plant, const Measurements& split,
                                       bool doubt);
/// @param rest  what it left out, listed
std::string NoteOfBudget(const Budget& budget, const std::string& rest);
std::string NoteOfQuietAxis(const std::string& channel, const std::string& joint);
std::string NoteOfInputDelay(double delay, double step);
/// "; trajectory 'multi' would, by 9 standard deviations": which of the setup tells two causes
/// apart.
std::string NoteOfExperiment(const Machine& machine, const Cause& one,
                             const Cause& other);

/// @param may_go_on  whether there is time for experiments
void AddNotes(const AnswerData& data, const UnseenJudgement& judged,
              const std::function<bool()>& may_go_on, Discovery& discovery);

/// White noise of sensors beyond what the setup says of them, as causes. Only where nothing
/// else is left: what a model lacks may look like noise.
void AddRaisedNoise(const AnswerData& data, const ModelOnRuns& answer,
                    const CandidateChoice& choice, Discovery& discovery);

}  // namespace mjdiag
