#pragma once
// How large the force is that a machine lacks at every joint: the mean square of its smoothed
// latent force less that of the error of its estimate, behind the noise of the machine as
// given, which is the same for all that are compared.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/comparison/missing_force.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"

namespace mjdiag {

/// The forces that a model lacks along what fits saw, or did not, behind the noise of the
/// machine as given.
/// @param changed  the machine with the model
/// @param path     of the machine as given
std::vector<MissingForce> ForcesBeside(const Machine& changed, const MeasuredRun& run,
                                       const FilterPath& path);

/// Of what accelerates the joints: so much is what physics steps are off by, and no
/// discrepancy that anybody means.
inline constexpr double kNegligible = 1e-3;

/// What accelerates every joint with a latent force along the run, rms.
Eigen::VectorXd UsualForces(const Machine& machine, const MeasuredRun& run,
                            const FilterPath& path);

/// @param counts  which samples do
Eigen::VectorXd PowerOf(const std::vector<MissingForce>& forces,
                        const SampleMask& counts);

/// Of all joints, each in units of what is usual there.
double InUnitsOf(const Eigen::VectorXd& usual, const Eigen::VectorXd& power);

/// On what fits did not see; on what they saw where a machine that rests lacks nothing there.
class MissingPower {
 public:
  /// Both have to outlive it.
  MissingPower(const AnswerData& data, const ModelOnRuns& nothing);
  const Eigen::VectorXd& given() const { return given_; }
  /// NumericalError where it diverges.
  Eigen::VectorXd Of(const Machine& changed) const;
  /// Whether somebody would miss what one takes away of another somewhere: a hundredth of
  /// what the machine as given lacks there, and a thousandth of what is usual.
  bool WouldBeMissed(const Eigen::VectorXd& with, const Eigen::VectorXd& without) const;

 private:
  const MeasuredRun* run_;
  const FilterPath* path_;
  SampleMask counts_;
  Eigen::VectorXd given_;
  Eigen::VectorXd least_;  ///< that somebody would miss
};

}  // namespace mjdiag
