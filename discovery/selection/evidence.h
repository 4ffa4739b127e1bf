#pragma once
// What is known about a set of hypotheses with fitted values:
//
//   criterion  Bayesian information criterion of the fitted part of the record,
//              deviance + |z|^2 + parameters log n, n independent values, z the numbers
//              of the plant in their standard deviations (model_choice.h)
//   unseen     deviance of what the fit did not see: the part held out, and other
//              records, which are replayed when first asked for
//   free run   how far a free simulation of those other records is off
//   addition   how much more than chance the hypothesis that came last explains
//
// All of these count independent values only. Which share of the samples that is
// depends on what a fit leaves, so it belongs to the evidence of that fit: a set that
// is added to is measured anew, on what the larger set leaves; a set whose hypotheses
// are dropped, exchanged or moved inherits the share. Two sets are compared by one
// share (comparator.h), and one that is turned down leaves nothing behind.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// The data that evidence is about. A record is cut into what settles, samples 0 ..
/// skip - 1, what is fitted, skip .. train - 1, and what is held out, train .. samples
/// - 1.
struct EvidenceData {
  Eigen::Index skip = 0;
  Eigen::Index train = 0;
  Eigen::Index samples = 0;
  /// Scaled innovations of another record beside it, stacked sample by sample;
  /// of no size where it cannot be run. May be empty: there is no other record.
  std::function<Eigen::VectorXd(const FittedModel& model)> replay;
  /// FreeRun of record_replay.h beside a model, on records that no fit sees. May be empty.
  std::function<double(const FittedModel& model)> free_run{};
  /// How many of samples first .. last - 1 of every sensor were measured, of the record
  /// and of the other one; empty: all.
  using Counts = std::function<Eigen::VectorXd(Eigen::Index first, Eigen::Index last)>;
  Counts measured{};
  Counts replay_measured{};
};

/// @param unseen    another record of the machine, or null
/// @param free_run  of changes to its plant, or empty
EvidenceData DataOf(const DiscoveryProblem& problem,
                    const std::vector<Candidate>& candidates, const MeasuredRun* unseen,
                    const std::function<double(const Changes&)>& free_run = {});

/// What one more hypothesis takes away beside what chance would: both in squared
/// innovations as of white sensor noise.
struct Significance {
  double gain = 0.0;
  double by_chance = 0.0;

  bool IsMoreThanChance() const { return gain > by_chance; }
};

/// What a gain is judged by.
struct Chance {
  double probability = 1e-4;  ///< to claim something where there is noise only
  int trials = 1;             ///< of which the best is judged
  /// By how much squared innovations change with what does not matter (unsteady_fit.h).
  double unsteadiness = 0.0;
};

class Evidence {
 public:
  Evidence() = default;
  /// @param independent  share of the samples of every sensor that count
  Evidence(EvidenceData data, CauseFit fit, Eigen::VectorXd independent,
           std::optional<Significance> addition = std::nullopt)
      : data_(std::move(data)),
        fit_(std::move(fit)),
        independent_(std::move(independent)),
        addition_(addition) {
    if (independent_.size() > 0) fit_.prior_weight = Inflation();
  }

  const CauseFit& fit() const { return fit_; }
  const Eigen::VectorXd& independent() const { return independent_; }
  /// Of the hypothesis that came last; none if that did not add to what there was.
  const std::optional<Significance>& addition() const { return addition_; }
  std::size_t hypotheses() const { return fit_.causes.size(); }

  /// With the own share, or another one for a comparison.
  double Criterion() const { return Criterion(independent_); }
  double Criterion(const Eigen::VectorXd& independent) const;
  /// Of the part held out and of other records; infinite where those cannot be run.
  double Unseen(const Eigen::VectorXd& independent) const;

  /// Sum of squared innovations of the same data; infinite as well.
  double UnseenSquares() const;

  /// Scaled innovations of other records; of no size without any, or where they cannot be
  /// run.
  const Eigen::VectorXd& Replayed() const;

  bool HasFreeRun() const { return static_cast<bool>(data_.free_run); }
  /// Log of what free simulation of unseen records leaves; 0 without such records.
  double FreeRun() const;

  /// By how much gains by chance are larger beside this set than in white noise alone:
  /// what it leaves may be more than sensor noise, and coloured.
  double Inflation(const Eigen::VectorXd& independent) const;
  double Inflation() const { return Inflation(independent_); }
  /// Sum of the squared innovations of the fitted part if noise is all there is.
  double Noise() const;
  /// Whether to take away `gain` of them is more than chance beside this set.
  /// @param freedom  parameters that take it away
  Significance SignificanceOf(double gain, int freedom, const Chance& chance,
                              const Eigen::VectorXd& independent) const;
  /// The same of a fit with one more hypothesis.
  Significance SignificanceOf(const CauseFit& after, const Chance& chance,
                              const Eigen::VectorXd& independent) const;

  /// Evidence of this set with one more hypothesis, measured on what that leaves.
  /// @param independent  share of the samples of every sensor in what it leaves
  Evidence Added(CauseFit fit, Eigen::VectorXd independent, const Chance& chance) const;
  /// Evidence of another fit that adds nothing to this set.
  Evidence Changed(CauseFit fit) const { return {data_, std::move(fit), independent_}; }

 private:
  EvidenceData data_;
  CauseFit fit_;
  Eigen::VectorXd independent_;
  std::optional<Significance> addition_;
  mutable std::optional<Eigen::VectorXd> replayed_;  // other records
  mutable std::optional<double> free_run_;
};

}  // namespace mjdiag
