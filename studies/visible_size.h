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
// that hides as much: gains by chance beside it are larger by its mean square over the share
// of its values that are independent.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/studies/observed_runs.h"

namespace mjdiag {

class VisibleSize {
 public:
  /// @param machine   as it is, without the effects, in the steps of the model
  /// @param substeps  physics steps a control tick of what is measured
  VisibleSize(const Machine& machine, int substeps, const Excitation& motion);

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
  /// The same of one of several causes, with the others there in any amount, beside
  /// whichever other law of the catalogue shows most of it to first order, with the values
  /// that explain most of it: where that is nothing, no record of this motion tells the two
  /// apart.
  double ShownBesideOtherLaws(const std::vector<Cause>& all, std::size_t one) const;
  double ShownBesideOtherLaws(const Cause& cause) const {
    return ShownBesideOtherLaws({cause}, 0);
  }
  Eigen::MatrixXd NoOthers() const { return {numbers_.rows(), 0}; }

 private:
  /// What a law leaves of a run, numbers and others in any amount beside it, its values such
  /// that it is least.
  double LeftBeside(const MeasuredRun& run, const Candidate& law,
                    Eigen::VectorXd values, const Eigen::MatrixXd& others) const;
  /// The law and values that explain most of innovations to first order, but for those
  /// that no measurement tells from a cause.
  struct OtherLaw {
    Candidate law;
    Eigen::VectorXd values;
    double left = 0.0;  ///< to first order
  };
  std::optional<OtherLaw> BestLaw(const Eigen::VectorXd& innovations,
                                  const Eigen::MatrixXd& others,
                                  const Cause& but_for) const;
  /// Its amplitudes in innovations, as far as they may be, and the squares that it takes.
  std::optional<std::pair<Eigen::VectorXd, double>> Regressed(
      const CandidateRegressor& trial, const Eigen::MatrixXd& response,
      const Eigen::MatrixXd& explained, const Eigen::VectorXd& left) const;
  std::vector<CandidateRegressor> RegressorsOf(
      const Candidate& law, const Eigen::VectorXd& innovations) const;

  ObservedRuns runs_;
  std::vector<ModelParameter> uncertain_;
  Eigen::MatrixXd numbers_;  // J
  double inflation_ = 1.0;
};

}  // namespace mjdiag
