#pragma once
// Whether a run begins at rest.

#include <Eigen/Core>

#include "mjdiag/diagnosis/twin/kept_readings.h"
#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

class RunStart {
 public:
  RunStart(Eigen::Index outputs, Eigen::Index ticks, Eigen::Index unknowns);

  /// Whether the first readings, as many as `ticks`, are those of a machine at rest that
  /// the known commands begin to move, and tones as large as they come: no farther from
  /// where theta lets it rest than the prior allows, and moving as it is predicted to.
  /// Leaves the twin anywhere. Does not allocate.
  /// @param theta       to begin with, p; no tones. Work space.
  /// @param first_tone  of the unknowns
  /// @param prior       covariance of theta, p x p
  bool BeganAtRest(Twin& twin, const KeptReadings& kept, Eigen::VectorXd& theta,
                   Eigen::Index first_tone, const Eigen::MatrixXd& prior) noexcept;

 private:
  Eigen::VectorXd reading_, none_, spread_;
  Eigen::MatrixXd predicted_;  // of three runs side by side
  Eigen::MatrixXd weighted_;
};

}  // namespace mjdiag
