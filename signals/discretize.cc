#include "mjdiag/signals/discretize.h"

#include <Eigen/LU>
#include <cmath>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void RequireContinuous(const StateSpace& system, double sample_time) {
  RequireShapes(system);
  if (system.sample_time != 0.0) {
    throw InputError("discretisation", "the system is discrete already",
                     "a continuous system");
  }
  if (!(sample_time > 0.0) || !std::isfinite(sample_time)) {
    throw InputError("discretisation",
                     "sample time " + std::to_string(sample_time) + " s",
                     "a positive time");
  }
}

}  // namespace

StateSpace DiscretizeZoh(const StateSpace& continuous, double sample_time) {
  RequireContinuous(continuous, sample_time);
  const Index n = continuous.states();
  const Index m = continuous.inputs();
  const VectorXd scales = BalancingScales(continuous.A);
  MatrixXd block = MatrixXd::Zero(n + m, n + m);
  block.topLeftCorner(n, n) =
      scales.cwiseInverse().asDiagonal() * continuous.A * scales.asDiagonal();
  block.topRightCorner(n, m) = scales.cwiseInverse().asDiagonal() * continuous.B;
  // The hold's columns do not feed back, so their size is free: kept small, they do not
  // add squarings.
  const double input_size = block.topRightCorner(n, m).cwiseAbs().sum();
  const double input_scale =
      input_size > 0.0 ? std::exp2(-std::ceil(std::log2(input_size))) : 1.0;
  block.topRightCorner(n, m) *= input_scale;
  const MatrixXd power = (block * sample_time).exp();
  if (!power.allFinite()) {
    throw NumericalError("discretisation: the matrix exponential is not finite");
  }
  return {scales.asDiagonal() * power.topLeftCorner(n, n) *
              scales.cwiseInverse().asDiagonal(),
          scales.asDiagonal() * power.topRightCorner(n, m) / input_scale, continuous.C,
          continuous.D, sample_time};
}

StateSpace DiscretizeTustin(const StateSpace& continuous, double sample_time) {
  RequireContinuous(continuous, sample_time);
  const Index n = continuous.states();
  const MatrixXd identity = MatrixXd::Identity(n, n);
  const MatrixXd half = 0.5 * sample_time * continuous.A;
  const Eigen::FullPivLU<MatrixXd> solver(identity - half);
  if (!solver.isInvertible()) {
    throw NumericalError("discretisation: the system has a pole at 2 / sample time");
  }
  const MatrixXd input = solver.solve(continuous.B) * sample_time;
  return {solver.solve(identity + half), input, continuous.C * solver.solve(identity),
          continuous.D + 0.5 * continuous.C * input, sample_time};
}

}  // namespace mjdiag
