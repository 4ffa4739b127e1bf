#pragma once
// What one whole run, all of its readings at hand, says of the numbers of its machine:
// the least squares of information.h about a theta that is given, for several runs to be
// added up. A run at rest begins there; else the twin is pulled along by its stiffest
// gain until it has forgotten how it began, and where it starts is either among the
// unknowns, and eliminated here, or forgotten.

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "mjdiag/diagnosis/twin/information.h"
#include "mjdiag/diagnosis/twin/kept_readings.h"
#include "mjdiag/diagnosis/twin/surprise.h"
#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

struct RunInformation {
  Eigen::MatrixXd H;           ///< of the numbers, n x n, without any prior
  Eigen::VectorXd g;           ///< n: H^-1 g is the change that it asks for
  double misfit = 1.0;         ///< mean square of the innovations over what is expected
  double worst_block = 1.0;    ///< the largest of a block,
  double worst_stretch = 1.0;  ///< and of the mean over recent ones (Surprise)
  Eigen::MatrixXd innovations;  ///< ny x ticks from the first that counts
};

class RunPass {
 public:
  /// @param outputs, inputs  readings and commands, a column a tick
  /// @param prior            covariance of all unknowns about 0, p x p
  RunPass(std::unique_ptr<Twin> twin, const Eigen::MatrixXd& outputs,
          const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& prior);

  bool at_rest() const { return at_rest_; }
  /// The softest gain with which the twin can tell this run (Twin::gains).
  std::size_t Finest() const;
  /// @param numbers  theta without the start, n
  RunInformation About(const Eigen::VectorXd& numbers, std::size_t gain);

 private:
  void Begin(const Eigen::VectorXd& numbers, std::size_t gain);
  /// Whatever the run says of where it began, eliminated.
  void Reduce(const Information& information, RunInformation& said);

  std::unique_ptr<Twin> twin_;
  KeptReadings run_;
  Eigen::MatrixXd prior_, known_;  // and its inverse
  bool at_rest_ = false;
  // Of the start: the last pass says how it goes with the numbers.
  Eigen::VectorXd numbers_, start_, start_step_;
  Eigen::MatrixXd start_by_numbers_;
};

}  // namespace mjdiag
