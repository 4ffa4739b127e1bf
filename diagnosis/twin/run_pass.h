#pragma once
// What one whole run, all of its readings at hand, says of the numbers of its machine: a
// pass about a theta that is given (twin_pass.h), for several runs to be added up. Where
// it began is eliminated here.

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "mjdiag/diagnosis/twin/kept_readings.h"
#include "mjdiag/diagnosis/twin/twin_pass.h"

namespace mjdiag {

/// Of a part of a run: what it adds to H and g.
struct PartInformation {
  Eigen::MatrixXd H;  ///< n x n
  Eigen::VectorXd g;  ///< n
};

struct RunInformation {
  Eigen::MatrixXd H;  ///< of the numbers, n x n, without any prior
  Eigen::VectorXd g;  ///< n: H^-1 g is the change that it asks for
  double nis = 1.0;   ///< mean square of the innovations over what is expected
  double excess =
      0.0;  ///< of the worst of them over what may be chance (NormalizedInnovation)
  /// Of kRunParts stretches of about one length, its start as it is estimated, or known.
  std::vector<PartInformation> parts;
  /// ny x ticks from the first that counts; NaN where there is no reading.
  Eigen::MatrixXd innovations;
};

/// So many tell their scatter with 15 degrees of freedom: with 8 parts, what is exceeded
/// with a probability of 1e-4 would be half as much again.
inline constexpr Eigen::Index kRunParts = 16;

class RunPass {
 public:
  /// @param outputs, inputs  readings and commands, a column a tick; NaN where a reading
  ///                         was not measured
  /// @param prior            covariance of all unknowns about 0, p x p
  RunPass(std::unique_ptr<Twin> twin, const Eigen::MatrixXd& outputs,
          const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& prior);

  bool at_rest() const { return start_.at_rest; }
  /// @param numbers  theta without the start, n
  RunInformation About(const Eigen::VectorXd& numbers, std::size_t gain);

 private:
  /// Whatever the run says of where it began, eliminated.
  void Reduce(RunInformation& said);

  TwinPass pass_;
  KeptReadings run_;
  Eigen::MatrixXd known_;  // inverse of the prior
  PassStart start_;        // of a twin that is pulled along, or at rest
  PassStart measured_;     // of one that answers linearly to where it starts
  // Of the start: the last pass says how it goes with the numbers.
  Eigen::VectorXd numbers_, start_theta_, start_step_;
  Eigen::MatrixXd start_by_numbers_;
};

}  // namespace mjdiag
