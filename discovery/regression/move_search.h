#pragma once
// The search for moves (moves.h): changes of a model, scored by one regression behind several
// noises (move_scores.cc), and which of them are looked at (moves.cc).

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/regression/fold_gram.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/discovery/regression/promising.h"

namespace mjdiag {

class MoveSearch {
 public:
  MoveSearch(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
             const std::vector<const RowMap*>& maps, std::vector<Block>& blocks,
             const std::vector<Term>& terms, const Column& other_steps, Looked looked)
      : machine_(machine),
        maps_(maps),
        along_{MotionAlong(machine, run, path), path.noise.reading,
               run.Time().maxCoeff(), path.dofs},
        blocks_(blocks),
        terms_(terms),
        other_steps_(other_steps),
        looked_(looked) {}

  Moves Run();

 private:
  static constexpr double kImpossible = std::numeric_limits<double>::infinity();

  /// A change of the model: terms that leave it, variations that come in.
  struct Change {
    std::vector<std::size_t> removed;
    std::vector<std::size_t> added;
  };
  struct Scored {
    Change change;
    double score = kImpossible;
    std::size_t noise = 0;
    bool other_steps = false;
    SetFit fit;
  };
  void Whiten();
  /// Behind those of the terms.
  Eigen::Index OtherStepsColumn() const {
    return terms_.empty()
               ? 0
               : first_of_term_.back() + std::ssize(terms_.back().columns) + 1;
  }
  SetOfColumns ColumnsOf(const Change& change) const;
  /// Errors of readings do no force: where forces are looked at, nothing is known of them.
  bool MayLeave(std::size_t term) const {
    return !IsBesideItsCurve(term) &&
           (!looked_.at_forces || !terms_[term].removed.states.empty());
  }
  bool IsBesideItsCurve(std::size_t term) const {
    return std::ranges::any_of(terms_, [&](const Term& other) {
      return IsCurveOf(blocks_[other.block], blocks_[terms_[term].block]);
    });
  }
  /// Terms that may leave for one that comes in.
  std::vector<std::vector<std::size_t>> LeavingTogether() const;
  std::vector<Variation> Promising(const Scored& here) const;
  /// Behind one of the noises.
  /// @param least  what variations have to gain there, beside their prices
  WhitenedModels ModelsBehind(std::size_t noise, double least) const;
  /// What comes in with its amplitudes, the last first.
  /// @param amplitudes  of all columns, those of what comes in last
  std::vector<std::pair<const Variation&, Eigen::VectorXd>> AddedOf(
      const Change& change, const Eigen::VectorXd& amplitudes) const;
  bool IsWithinBounds(const Change& change, const Eigen::VectorXd& amplitudes) const;
  /// Whether each of what comes in is worth its price by what folds have in common.
  bool IsRepeated(const Change& change, const Scored& scored) const;
  /// What sizes cost.
  double SizesOf(const Change& change, const SetOfColumns& set,
                 const Eigen::VectorXd& amplitudes) const;
  /// Whether a variation can come in beside those of a change.
  bool IsApart(const Change& change, std::size_t variation) const;
  static Change With(Change change, std::size_t variation) {
    change.added.push_back(variation);
    return change;
  }
  /// Whether it is looked at beside what is in.
  bool MayCome(const Block& block) const;
  /// With what a group that comes in takes the place of.
  Change Completed(Change change) const;
  /// @param asks_folds  whether each of what comes in has to be worth its price
  Scored ScoreOf(const Change& change, bool asks_folds = true) const;
  std::vector<Scored> ScoresOf(std::vector<Change> changes) const;
  /// Further members come in at once as long as each brings a share of what the others do,
  /// beside which what is of second order is little.
  /// @param may  which blocks
  void Extend(Scored& best, double share,
              const std::function<bool(const Block&)>& may) const;
  /// What resists a joint is dry and viscous: one of them alone makes up for the other. Both
  /// come in where what the other costs is of second order; fits take out what is not there.
  void CompleteResistances(Scored& best) const;
  void Keep(const std::vector<Scored>& scored);

  const Machine& machine_;
  const std::vector<const RowMap*>& maps_;
  BlockMotion along_;
  std::vector<Block>& blocks_;
  const std::vector<Term>& terms_;
  const Column& other_steps_;
  Looked looked_;
  std::vector<Variation> kept_;
  std::vector<Eigen::Index> first_of_term_, first_of_kept_;
  std::vector<FoldGram> grams_;
  Moves moves_;
};

}  // namespace mjdiag
