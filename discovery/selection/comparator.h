#pragma once
// The one rule by which a search goes from a set of hypotheses to another, whether it
// adds a hypothesis, drops one, puts one in the place of another or gives one another
// period. With C the criterion, U the deviance of unseen data and k the number of
// hypotheses (evidence.h), ' those of the proposed set, it is accepted if
//
// 1. the criterion falls:   C - C' > margin
//    margin = 1 if the hypotheses are the same with other values, which costs the
//    criterion nothing, else 0;
// 2. what is added is more than chance:   k' <= k, or
//    (N (m - m') - unsteadiness) / inflation > chi-squared quantile of the best trial,
//    N values, m their mean square; inflation = max(1, m) / least independent share;
// 3. unseen data agree:   U' - U <= max(0, P - P') if k' > k, else C - C'
//    a larger set must not spoil them, by more than what is known beforehand, P =
//    PriorOf, speaks for it; one that is no larger must not lose there more than it gains
//    where it was fitted. Data on which neither set can be run say nothing;
// 4. in the place of that, where the present set leaves far more than noise and there are
//    unseen records, their free simulation agrees:   F' - F <= 0.02, F its log rms
//    (record_replay.h). What is left then is physics that neither set has: an observer
//    hides what it does, and follows it better beside one wrong law than another.
//
// Both sets are counted with the independent share of the proposed one: what the larger
// set leaves if it adds, else the share that it has inherited from the present one.

#include <cstddef>
#include <optional>
#include <vector>

#include "mjdiag/discovery/selection/evidence.h"

namespace mjdiag {

enum class Judgement {
  kAccepted,
  kCriterion,  ///< the criterion does not fall
  kChance,     ///< what is added may be chance
  kUnseen      ///< unseen data speak against it, behind the observer or free
};

/// The clauses in that order: unseen records are replayed only where the others hold.
Judgement Judge(const Evidence& present, const Evidence& proposed);

/// Which of the proposed sets comes into the place of the present one: each is judged
/// against the best so far. None if none is accepted; a proposal that could not be fitted
/// is none.
std::optional<std::size_t> BestOf(const Evidence& present,
                                  const std::vector<std::optional<Evidence>>& proposed);

}  // namespace mjdiag
