#pragma once
// What a motion tells of the numbers of a machine: the information of Cramer and Rao of
// its linear model, along the commands of a run,
//
//   I = sum_t psi_t^T R^-1 psi_t,   psi_t = d y_t / d theta,   Cov theta^ >= I^-1
//
// The reference makes the commands through a linear loop, and psi is linear in them: two
// motions at once tell I_1 + I_2 + 2 I_12, and the mixed part is nothing where they have
// no frequency in common.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

class MotionInformation {
 public:
  /// Of all fault parameters of the plant and of numbers of it ("mass@x_stage"), all
  /// unknown together, in motions of so many ticks. InputError on a number that the plant
  /// does not have, or where there is neither.
  MotionInformation(const Machine& machine, const std::vector<std::string>& numbers,
                    Eigen::Index ticks);

  /// Fault parameters in the order of the plant, then the numbers.
  const std::vector<std::string>& unknowns() const { return names_; }

  /// I of those samples of a run, square of the unknowns.
  Eigen::MatrixXd Of(const Record& run, Eigen::Index from, Eigen::Index count) const;

  /// Standard deviations from the whole of a run of that many ticks, where nobody knows
  /// the disturbances of the setup either: of each of their tones a sine and a cosine.
  /// InputError on a sensor without noise, NumericalError if the run does not tell the
  /// unknowns apart.
  Eigen::VectorXd SdOf(const Record& run) const;

 private:
  /// By each of the unknowns, of every block.
  std::vector<Eigen::MatrixXd> Sensitivities(const Record& run, Eigen::Index from,
                                             Eigen::Index count) const;

  std::vector<std::string> inputs_;  // actuator channels
  std::vector<std::string> names_;
  std::vector<PerturbedModels> models_;
  TickTiming timing_;
  Eigen::VectorXd noise_;
  std::vector<Eigen::MatrixXd> disturbances_;  // of every block
};

}  // namespace mjdiag
