#pragma once
// Controllers of a machine that is not what it was: estimates of its faults change what
// the controllers command, while it runs. Three actions, on the axes of a machine,
//
//   u = g (u_ff + F r) + C(g e) - w,    g = 1 / (1 + d)
//
// drive gain: a drive with 1 + d of its force gets commands 1 / (1 + d) as large, kept
//   inside gains of the loop that are known to be stable (FaultRemedy, Reconfiguration);
// feedforward: forces F r along the reference and its derivatives, of what friction and
//   stiffness have become. They do not enter the loop;
// tones of a disturbance w, cancelled in amplitude and phase. Nor do they.
//
// Only what is certain is acted on, and without a jump. With the estimate d of a fault,
// its standard deviation sd and the size k of what is no chance:
//
// - A fault is certain where |d| > k sd for as long as `persistence`, and stays so until
//   |d| < k sd / 2. What is smaller than is worth acting on is left alone.
// - A fault that is gone is let go at once: an estimate that would see one of the size
//   that is being acted on, k sd < |it|, and does not. An estimate that has become too
//   uncertain to say so is given `patience`.
// - What acts follows through a low-pass, down to nothing as well as up. Slow against
//   the loop, the machine passes through states in each of which its loop is stable and
//   as good as at rest: C. A. Desoer, "Slowly varying discrete system x[i+1] = A[i]
//   x[i]", Electronics Letters 6, 1970.
//
// Everything is allocated in the constructor.

#include <Eigen/Core>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/controllers/reference.h"

namespace mjdiag {

/// How forces along the reference grow with the deviation d of a fault.
enum class ForceLaw {
  kProportional,  ///< as d: dampers
  kCompliance     ///< as 1 / (1 + d) - 1: springs between driven masses, that give
};

/// Forces of the drives along the reference r of all axes, at a unit of the law, each
/// axes x axes, [actuator unit / unit of the axis and its derivative]; empty: none.
struct ReferenceForces {
  Eigen::MatrixXd position;  ///< of the reference less its value at rest
  Eigen::MatrixXd velocity;
  Eigen::MatrixXd acceleration;
  Eigen::MatrixXd snap;
};

/// amplitude * (s sin(2 pi f t) + c cos(2 pi f t)) on the actuators, t = 0 at tick 0.
struct RemediedTone {
  double frequency = 0.0;     ///< [Hz]
  Eigen::VectorXd amplitude;  ///< of every axis [actuator unit]
};

/// What is done about a fault.
struct FaultRemedy {
  std::string fault;
  std::vector<Eigen::Index> drives;  ///< axes that have 1 + d of their force
  ForceLaw law = ForceLaw::kProportional;
  ReferenceForces forces;
  std::vector<RemediedTone> tones;
  /// Deviations for which it is known to be safe; others count as the nearest of them.
  double least = -0.7;
  double most = 2.0;
};

/// An axis as it is corrected.
struct RemediedAxis {
  double drive_gain = 1.0;  ///< actuator unit per command unit
  double rest = 0.0;        ///< reading at rest
  double least_gain = 1.0;  ///< g between which the loop is known to be stable
  double most_gain = 1.0;
};

struct ReconfigurationOptions {
  double sample_time = 0.0;    ///< [s]
  double sigmas = 5.0;         ///< k
  double least = 0.0;          ///< deviations that are no more are not acted on
  double time_constant = 0.0;  ///< of the low-pass [s]
  double persistence = 0.0;    ///< [s]
  double patience = 0.0;       ///< [s]
};

/// What an estimator knows of the faults, in the order of their remedies.
struct FaultEstimates {
  Eigen::VectorXd deviation;  ///< d, from healthy
  Eigen::VectorXd sd;         ///< NaN: not known
  Eigen::VectorXd tones;      ///< s and c of every tone of every remedy
};

/// What is done about a fault now, and since when.
struct RemedyState {
  double acting = 0.0;      ///< deviation that is acted on
  bool certain = false;     ///< or it is on its way back
  Eigen::Index since = -1;  ///< tick at which it became certain first; -1: never
  Eigen::Index until = -1;  ///< tick at which it ceased to be last; -1: it is, or never
};

/// What becomes of the command of an axis.
struct AxisCorrection {
  double gain = 1.0;      ///< AxisController::SetGain
  double addition = 0.0;  ///< [command unit]
};

class Reconfiguration {
 public:
  /// InputError on a remedy for an axis that there is not, or a time that is not
  /// positive.
  Reconfiguration(std::vector<RemediedAxis> axes, std::vector<FaultRemedy> remedies,
                  const ReconfigurationOptions& options);

  /// Estimates made for the places of the remedies, to begin with healthy ones.
  FaultEstimates MakeEstimates() const;
  /// Once a tick, after it: what the estimator says now acts from the next one on. Does
  /// not allocate, lock, throw or do I/O.
  void Observe(const FaultEstimates& estimates) noexcept;
  /// At the start of a tick. Does not allocate, lock, throw or do I/O.
  /// @param references  of this tick, of every axis
  /// @return for every axis
  std::span<const AxisCorrection> Correct(
      std::span<const ReferenceSample> references) noexcept;

  const std::vector<FaultRemedy>& remedies() const { return remedies_; }
  const std::vector<RemediedAxis>& axes() const { return axes_; }
  const ReconfigurationOptions& options() const { return options_; }
  /// Of every remedy.
  const std::vector<RemedyState>& states() const { return states_; }
  /// As the last tick had them.
  std::span<const AxisCorrection> corrections() const { return corrections_; }

 private:
  struct Decision {
    double held = 0.0;         // deviation to act on
    Eigen::Index seen = 0;     // ticks for which it has been certain
    Eigen::Index doubted = 0;  // ticks for which it has not been
  };
  void Decide(std::size_t remedy, double deviation, double sd) noexcept;

  std::vector<RemediedAxis> axes_;
  std::vector<FaultRemedy> remedies_;
  ReconfigurationOptions options_;
  double step_;  // of the low-pass in a tick
  Eigen::Index persistence_, patience_;
  std::vector<Decision> decisions_;
  std::vector<RemedyState> states_;
  Eigen::VectorXd tones_;  // s and c that are cancelled
  std::vector<AxisCorrection> corrections_;
  Eigen::VectorXd force_;  // of every axis, less the gain
  Eigen::VectorXd cancelled_;
  Eigen::VectorXd position_, velocity_, acceleration_, snap_;
  Eigen::Index ticks_ = 0;
};

}  // namespace mjdiag
