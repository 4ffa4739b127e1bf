#pragma once
// What a machine lacks along a run: a set of variations of blocks (block.h), chosen by how
// well it predicts parts of the run that it was not fitted to,
//
//   score = -2 ln p(unseen folds) + prices of its blocks,
//
// behind the noise that suits the set best: a set that is right deserves smaller latent
// forces than the plant as given. Sets grow by one or two members, members are exchanged,
// and those that are not needed left out, until nothing pays.
//
// All shapes of all laws are looked at along what the present set leaves: inner products
// with W^T of it say how much each would take away, and W^T of white noise how large each
// is behind the filter, |W f|^2 = E (f . W^T n)^2. The most promising of every block are
// then whitened themselves.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

struct ChosenMember {
  Variation variation;
  Eigen::VectorXd amplitudes;
  Eigen::VectorXd sd;
  double loss = 0.0;  ///< of the score without it
};

struct ChosenSet {
  std::vector<ChosenMember> members;
  double score = 0.0;
  double score_of_nothing = 0.0;
  FilterNoise noise;  ///< behind which it is best
  std::vector<Block> blocks;
};

struct ChoiceOptions {
  int most = 12;  ///< members
  /// After every round, for people.
  std::function<void(const std::string&)> progress;
};

/// @param candidates  laws of the catalogue at their sites
ChosenSet ChooseSet(const Machine& machine, const MeasuredRun& run,
                    const FilterPath& path, const std::vector<Candidate>& candidates,
                    const ChoiceOptions& options);

}  // namespace mjdiag
