#include "mjdiag/studies/excitation/inertial_information.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is smaller of the largest pivot is rounding: numbers that no motion tells.
constexpr double kDependent = 1e-8;
constexpr Index kPlaces = 200;

/// Positions, velocities and accelerations anywhere within the limits.
JointMotion Anywhere(const std::vector<AxisLimits>& limits) {
  const Index joints = std::ssize(limits);
  JointMotion anywhere{MatrixXd(joints, kPlaces), MatrixXd(joints, kPlaces),
                       MatrixXd(joints, kPlaces)};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (Index k = 0; k < kPlaces; ++k) {
    for (Index j = 0; j < joints; ++j) {
      const AxisLimits& own = limits[static_cast<std::size_t>(j)];
      anywhere.position(j, k) = 0.5 * (own.lowest + own.highest) +
                                0.5 * share(random) * (own.highest - own.lowest);
      anywhere.velocity(j, k) = share(random) * own.velocity;
      anywhere.acceleration(j, k) = share(random) * own.acceleration;
    }
  }
  return anywhere;
}

}  // namespace

InertialRows RowsAlong(InertialRegressor& regressor, const JointMotion& motion,
                       const std::vector<Index>& numbers, const VectorXd& noise) {
  const Index samples = motion.position.cols(), joints = motion.position.rows();
  const VectorXd values = regressor.Values();
  InertialRows rows{MatrixXd(joints * samples, std::ssize(numbers)),
                    VectorXd::Zero(joints)};
  for (Index k = 0; k < samples; ++k) {
    const MatrixXd Y = regressor.At(motion.position.col(k), motion.velocity.col(k),
                                    motion.acceleration.col(k));
    rows.touches = rows.touches || regressor.Touches();
    rows.force = rows.force.cwiseMax((Y * values).cwiseAbs());
    for (Index c = 0; c < std::ssize(numbers); ++c) {
      for (Index j = 0; j < joints; ++j) {
        rows.W(j * samples + k, c) =
            Y(j, numbers[static_cast<std::size_t>(c)]) / noise[j];
      }
    }
  }
  return rows;
}

InertialInformation InformationOf(const MatrixXd& W, double times) {
  const auto [values, vectors] = SymmetricEigenDecomposition(W.transpose() * W);
  const double largest = values.tail(1)[0];
  if (!(values[0] > largest * std::numeric_limits<double>::epsilon())) return {};
  const auto shares = vectors.array().square();
  return {
      std::sqrt(largest / values[0]),
      ((shares.rowwise() / values.transpose().array()).rowwise().sum() / times).sqrt()};
}

std::vector<Index> BaseNumbers(InertialRegressor& regressor,
                               const std::vector<AxisLimits>& limits) {
  std::vector<Index> all;
  for (Index i = 0; i < regressor.numbers(); ++i) all.push_back(i);
  MatrixXd W =
      RowsAlong(regressor, Anywhere(limits), all, VectorXd::Ones(regressor.joints())).W;
  // In any units; what is rounding of the others stays it.
  const VectorXd size = W.colwise().norm();
  for (Index c = 0; c < W.cols(); ++c)
    W.col(c) /= std::max(size[c], kDependent * size.maxCoeff());
  return IndependentColumns(W, kDependent);
}

VectorXd NoiseBeside(InertialRegressor& regressor, const JointMotion& motion,
                     const std::vector<Index>& numbers, const MatrixXd& forces) {
  const Index joints = forces.rows(), samples = forces.cols();
  const double free =
      std::max(1.0, static_cast<double>(samples) - static_cast<double>(numbers.size()) /
                                                       static_cast<double>(joints));
  VectorXd noise = VectorXd::Ones(joints);
  // Once with all joints alike, once with each as noisy as that has shown.
  for (int pass = 0; pass < 2; ++pass) {
    const MatrixXd W = RowsAlong(regressor, motion, numbers, noise).W;
    const MatrixXd weighted =
        (forces.array().colwise() / noise.array()).matrix().transpose();
    const VectorXd f = weighted.reshaped();
    const VectorXd left = f - W * LeastSquaresOfOne(W, f);
    for (Index j = 0; j < joints; ++j)
      noise[j] *= std::sqrt(left.segment(j * samples, samples).squaredNorm() / free);
  }
  return noise;
}

}  // namespace mjdiag
