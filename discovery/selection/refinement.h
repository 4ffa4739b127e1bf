#pragma once
// What a new cause means for those found before it. With it beside them
//
// - a wave or a resonance may have another period (wave_period.h);
// - one may be superfluous: it is dropped if the criterion (model_choice.h) likes that;
// - another candidate may be the better one in its place: the first cause of a search
//   is what explains the most on its own, and a flexible mode that made up for two
//   effects at once is a mere mass once the other one is known.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/selection/contender.h"

namespace mjdiag {

/// Causes that explain the record together.
struct CauseSet {
  CauseFit fit;
  /// Of every cause of the fit, who else could be in its place, itself included.
  std::vector<std::vector<Contender>> contenders;
};

class Refinement {
 public:
  /// @param beginning    of the problem, for what shows early
  /// @param independent  share of the samples of every sensor that the criterion counts
  /// @param unseen       deviance of data that a fit did not see, which has a say in an
  ///                     exchange
  Refinement(const DiscoveryProblem& problem, const DiscoveryProblem& beginning,
             const std::vector<Candidate>& candidates,
             const Eigen::VectorXd& independent,
             std::function<double(const CauseFit&)> unseen)
      : problem_(problem),
        beginning_(beginning),
        candidates_(candidates),
        independent_(independent),
        unseen_(std::move(unseen)) {}

  /// Gives waves of the set other periods while that explains more.
  void ChangePeriods(CauseSet& set) const;
  /// Drops the cause whose loss the criterion likes best; true if there was one.
  bool Prune(CauseSet& set) const;
  /// Puts another contender for it in the place of a cause, if the criterion likes that
  /// and still does together with unseen data; true if there was one. Contenders are
  /// judged anew in any case.
  bool Exchange(CauseSet& set) const;

 private:
  double CriterionOf(const CauseFit& fit) const;
  double EarlyDeviance(const CauseFit& fit) const;
  std::optional<CauseFit> FitUnlessFar(const CauseFit& present,
                                       const std::vector<FittedCause>& causes,
                                       const Eigen::MatrixXd& known) const;
  std::vector<std::optional<CauseFit>> FitInPlace(
      const CauseFit& present, std::size_t i,
      const std::vector<FittedCause>& others) const;
  bool ChangePeriod(CauseSet& set, std::size_t i) const;
  std::vector<FittedCause> Challengers(const CauseFit& fit, std::size_t i) const;
  bool ExchangeAt(CauseSet& set, std::size_t i) const;

  const DiscoveryProblem& problem_;
  const DiscoveryProblem& beginning_;
  const std::vector<Candidate>& candidates_;
  const Eigen::VectorXd& independent_;
  std::function<double(const CauseFit&)> unseen_;
};

}  // namespace mjdiag
