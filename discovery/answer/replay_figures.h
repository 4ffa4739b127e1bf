#pragma once
// How much better a machine is predicted with the answer: replays of every record before and
// after, and the ladder of its members.

#include <cstdint>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Records, mismatch per channel, noise floors and gains. By free simulation; where the
/// machine falls in it, or a model that predicts better does no better in it (a motion that
/// does not forget where it began), by what is predicted over a tick.
/// @param steps  that the records know
/// @param near   to it the noise is behind which the plant as given is followed
/// @return whether by the latter
bool AddReplays(const Measurements& measurements, const Changes& changes,
                PhysicsSteps steps, Eigen::Index skip, std::uint64_t seed,
                const FilterNoise& near, Discovery& discovery);

/// After every member, the one that is worth most first: innovations over their standard
/// deviation behind the filter of the whole answer, in what fits saw and in what they did
/// not. And how far these are from white.
/// @param follows  no free simulation says anything
void AddLadderOf(const AnswerData& data, const UnseenJudgement& judged,
                 const Measurements& measurements, bool follows, Discovery& discovery);

}  // namespace mjdiag
