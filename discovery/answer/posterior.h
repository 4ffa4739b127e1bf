#pragma once
// How probable every member of an answer is, and what could be in its place: sums of one
// posterior over the model as it is, the model without the member, and the models in which
// another block is where it was,
//
//   p = exp(-score / 2) / sum of those of all of them,
//
// each score -2 ln of the data and all that the model costs, prices of blocks and of their
// sizes included. Latent forces are in every one of them: that the law is in no list has its
// share of all.
//
// The model without a member was fitted, and so were its likeliest exchanges, and their scores
// count unseen data, too (unseen_judgement.h); further exchanges are of first order about the
// model (moves.h).

#include <cstddef>
#include <vector>

#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/fit/explain.h"

namespace mjdiag {

struct Rival {
  std::size_t block = 0;
  Eigen::VectorXd values;
  double probability = 0.0;
};

struct MemberPosterior {
  double probability = 1.0;   ///< of the member
  double none = 0.0;          ///< that there is nothing in its place
  std::vector<Rival> rivals;  ///< the most probable first
};

/// Of the members of the answer.
std::vector<MemberPosterior> PosteriorOf(const Explained& explained,
                                         const UnseenJudgement& judged);

}  // namespace mjdiag
