#pragma once
// Where a run may be said to begin: at rest, or at its quietest tick.

#include <Eigen/Core>

#include "mjdiag/diagnosis/twin/kept_readings.h"
#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

class RunStart {
 public:
  RunStart(Eigen::Index outputs, Eigen::Index ticks);

  /// Whether the first readings, as many as `ticks`, are those of a machine at rest that
  /// the known commands begin to move, and tones as large as they come. Leaves the twin
  /// anywhere. Does not allocate.
  /// @param theta       to begin with, p; no tones. Work space.
  /// @param first_tone  of the unknowns
  bool BeganAtRest(Twin& twin, const KeptReadings& kept, Eigen::VectorXd& theta,
                   Eigen::Index first_tone) noexcept;

 private:
  Eigen::VectorXd reading_, none_;
  Eigen::MatrixXd predicted_;  // of three runs side by side
};

/// The tick, a whole number of blocks from the first, before which readings move least
/// in a block, in units of what noise moves them.
/// @param covariance  of the noise, ny x ny
Eigen::Index QuietestTick(const KeptReadings& kept, Eigen::Index from, Eigen::Index to,
                          Eigen::Index block,
                          const Eigen::MatrixXd& covariance) noexcept;

}  // namespace mjdiag
