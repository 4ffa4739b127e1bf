#pragma once
// How large an effect has to be for a record to show it beside numbers of the plant that
// nobody knows exactly: a heavier stage is a weaker motor as far as either may be off.
// What an effect shows is what of its scaled innovations r no such numbers explain,
//
//   min over z, a of |r - J z - R a|^2 + |z|^2
//
// z the numbers in the standard deviations of what is known of them, J what they do to
// the innovations, R what other effects in the same machine show, in any amount a. It is
// counted in what chance makes of as much: the model's physics steps are too long by
// themselves, and what the numbers cannot make up for of that is no white noise but rest
// that hides as much (Inflation of model_choice.h).

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class VisibleSize {
 public:
  /// @param machine   as it is, without the effects, in the steps of the model
  /// @param substeps  physics steps a control tick of what is measured
  VisibleSize(const Machine& machine, int substeps, const Excitation& motion,
              std::uint64_t seed);

  Scales ScalesAt(const Site& site) const;
  /// The scaled innovations of the machine beside a run of it with the cause, without
  /// noise. NumericalError if that diverges.
  Eigen::VectorXd Innovations(const Cause& cause) const;
  /// What the cause shows, as beside white noise. @param beside  R, may have no columns
  double Shown(const Cause& cause, const Eigen::MatrixXd& beside) const;
  /// The same beside the law that it becomes at an end of its parameters, with the values
  /// that explain most of it; infinite where there is no such law. Less than that and the
  /// simpler law is what there is.
  double ShownBesideSimplerLaw(const Cause& cause) const;
  /// The same beside whichever other law of the catalogue shows most of it, to first order:
  /// where that is nothing, no record of this motion tells the two apart.
  double ShownBesideOtherLaws(const Cause& cause) const;
  /// The same of one of several causes, with the others there: what the record shows of it
  /// beside the law in its place that shows most of it, with the values that explain most
  /// of it. None of them is noise.
  double ShownBesideOtherLaws(const std::vector<Cause>& all, std::size_t one) const;
  Eigen::MatrixXd NoOthers() const { return {numbers_.rows(), 0}; }

 private:
  /// What a fit of that model leaves of the innovations.
  double LeftBy(const DiscoveryProblem& quiet, const std::vector<Candidate>& candidates,
                const FittedModel& model) const;
  DiscoveryProblem WithQuietRunOf(const Machine& measured) const;

  Excitation motion_;
  DiscoveryProblem problem_;
  ObservedMotion observed_;
  Eigen::MatrixXd numbers_;  // J
  double inflation_ = 1.0;
};

}  // namespace mjdiag
