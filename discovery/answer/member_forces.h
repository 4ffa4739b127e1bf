#pragma once
// How large the force of every member of a model is, along the motion: what the machine does
// otherwise without it in every tick, as forces at the joints. One that is no more at any
// joint than a hundredth of what all of them do there is nothing that anybody would miss,
// however surely many samples tell it.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"

namespace mjdiag {

/// Of every member; false of errors of readings, which are no forces.
std::vector<bool> NobodyWouldMiss(const AnswerData& data, const ModelOnRuns& answer);

}  // namespace mjdiag
