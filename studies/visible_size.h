#pragma once
// How large an effect has to be for a record to show it beside numbers of the plant that
// nobody knows exactly: a heavier stage is a weaker motor as far as either may be off.
// What an effect shows is what of its scaled innovations r no such numbers explain,
//
//   min over z, a of |r - J z - R a|^2 + |z|^2
//
// z the numbers in the standard deviations of what is known of them, J what they do to
// the innovations, R what other effects in the same machine show, in any amount a.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class VisibleSize {
 public:
  /// @param machine  as it is, without the effects
  VisibleSize(const Machine& machine, const Excitation& motion, std::uint64_t seed);

  Scales ScalesAt(const Site& site) const;
  /// The scaled innovations of the machine beside a run of it with the cause, without
  /// noise. NumericalError if that diverges.
  Eigen::VectorXd Innovations(const Cause& cause) const;
  /// What each of several causes shows, of their innovations.
  std::vector<double> Shown(const std::vector<Eigen::VectorXd>& innovations) const;

 private:
  Excitation motion_;
  DiscoveryProblem problem_;
  ObservedMotion observed_;
  Eigen::MatrixXd numbers_;  // J
};

}  // namespace mjdiag
