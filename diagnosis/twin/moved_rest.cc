#include "mjdiag/diagnosis/twin/moved_rest.h"

#include <cmath>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// K with as stiff a spring as its own for every motion that none of them holds. Where
/// the forces do not push that way, it does not move anything.
MatrixXd WithLooseHeld(const MechanicalModel& model) {
  constexpr double kLoose = 1e-10;  // of the stiffest
  // Scaling by the masses makes slides and hinges comparable.
  const VectorXd scale = model.M.diagonal().cwiseSqrt();
  const MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * model.K * scale.cwiseInverse().asDiagonal();
  const auto [values, vectors] =
      SymmetricEigenDecomposition(0.5 * (scaled + scaled.transpose()));
  const double stiffest = values.cwiseAbs().maxCoeff();
  MatrixXd held = model.K;
  for (Index i = 0; i < values.size(); ++i) {
    if (std::abs(values[i]) > kLoose * stiffest) continue;
    const VectorXd loose = scale.asDiagonal() * vectors.col(i);
    held += (stiffest > 0.0 ? stiffest : 1.0) * loose * loose.transpose();
  }
  return held;
}

}  // namespace

MovedRest::MovedRest(const MechanicalModel& nominal,
                     const std::vector<ModelPart>& parts, Index unknowns)
    : held_(WithLooseHeld(nominal)), K_(held_), solver_(held_.rows()) {
  for (const ModelPart& part : parts) {
    if (part.K.size() > 0 || part.force.size() > 0) parts_.push_back(part);
    moves_ = moves_ || part.force.size() > 0;
  }
  force_ = position_ = moved_ = VectorXd::Zero(held_.rows());
  sensitivity_ = MatrixXd::Zero(held_.rows(), unknowns);
}

void MovedRest::Find(const VectorXd& theta) noexcept {
  if (!moves_) return;
  const auto logarithm = [&](const ModelPart& part) {
    double sum = 0.0;
    for (const Index factor : part.factors) sum += theta[factor];
    return sum;
  };
  K_ = held_;
  force_.setZero();
  for (const ModelPart& part : parts_) {
    const double moved = std::expm1(logarithm(part));
    if (part.K.size() > 0) K_ += moved * part.K;
    if (part.force.size() > 0) force_ += moved * part.force;
  }
  solver_.compute(K_);
  position_.noalias() = solver_.solve(force_);
  sensitivity_.setZero();
  for (const ModelPart& part : parts_) {
    force_.setZero();
    if (part.force.size() > 0) force_ = part.force;
    if (part.K.size() > 0) force_.noalias() -= part.K * position_;
    force_ *= std::exp(logarithm(part));
    moved_.noalias() = solver_.solve(force_);
    for (const Index factor : part.factors) sensitivity_.col(factor) += moved_;
  }
}

}  // namespace mjdiag
