#include "mjdiag/studies/excitation/fourier_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// How finely peaks are looked for, in samples of the fastest period.
constexpr Index kPeaksPerPeriod = 32;

/// What is beyond 0 .. 1 is mirrored there.
double Folded(double value) {
  const double within = std::abs(std::remainder(value, 2.0));
  return std::clamp(within, 0.0, 1.0);
}

/// An orthonormal basis of what is at right angles to a vector.
MatrixXd BesideOf(const VectorXd& vector) {
  return OrthonormalBasis(vector).rightCols(vector.size() - 1);
}

/// What begins at rest, or its derivative in time of that order: combinations of sines, then
/// of cosines, each with velocities of the same mean square.
MatrixXd Waves(double duration, int harmonics, Index samples, int derivative) {
  const double w = 2.0 * std::numbers::pi / duration;
  const VectorXd time = VectorXd::LinSpaced(samples, 0.0, duration);
  const VectorXd order = VectorXd::LinSpaced(harmonics, 1.0, harmonics);
  MatrixXd sines(samples, harmonics), cosines(samples, harmonics);
  for (Index i = 0; i < harmonics; ++i) {
    const double rate = order[i] * w;
    const double quarters = 0.5 * std::numbers::pi * derivative;
    const double size = std::pow(rate, derivative - 1);
    sines.col(i) = size * (rate * time.array() + quarters).sin();
    cosines.col(i) = size * (rate * time.array() + quarters).cos();
  }
  MatrixXd waves(samples, 2 * harmonics - 2);
  waves << sines * BesideOf(VectorXd::Ones(harmonics)), cosines * BesideOf(order);
  return waves;
}

}  // namespace

FourierMotion::Basis FourierMotion::MakeBasis(double duration, int harmonics,
                                              Index samples) {
  return {Waves(duration, harmonics, samples, 0),
          Waves(duration, harmonics, samples, 1),
          Waves(duration, harmonics, samples, 2)};
}

FourierMotion::FourierMotion(double duration, int harmonics,
                             std::vector<AxisLimits> limits, Index samples)
    : limits_(std::move(limits)),
      wanted_(MakeBasis(duration, harmonics, samples)),
      fine_(MakeBasis(duration, harmonics, kPeaksPerPeriod * harmonics + 1)) {}

JointMotion FourierMotion::At(const VectorXd& parameters) const {
  const Index shapes = fine_.position.cols(), samples = wanted_.position.rows();
  const Index joints = std::ssize(limits_);
  JointMotion motion{MatrixXd(joints, samples), MatrixXd(joints, samples),
                     MatrixXd(joints, samples)};
  for (Index j = 0; j < joints; ++j) {
    const auto own =
        parameters.segment(j * parameters_of_a_joint(), parameters_of_a_joint());
    const VectorXd shape = own.head(shapes);
    const AxisLimits& limits = limits_[static_cast<std::size_t>(j)];
    const VectorXd positions = fine_.position * shape;
    const double lowest = positions.minCoeff();
    const double width = positions.maxCoeff() - lowest;
    const double range = limits.highest - limits.lowest;
    double size = 0.0;
    if (width > 0.0) {
      size = Folded(own[shapes + 1]) *
             std::min({range / width,
                       limits.velocity / (fine_.velocity * shape).cwiseAbs().maxCoeff(),
                       limits.acceleration /
                           (fine_.acceleration * shape).cwiseAbs().maxCoeff()});
    }
    const double offset =
        limits.lowest - size * lowest + Folded(own[shapes]) * (range - size * width);
    motion.position.row(j) = (size * (wanted_.position * shape)).array() + offset;
    motion.velocity.row(j) = size * (wanted_.velocity * shape);
    motion.acceleration.row(j) = size * (wanted_.acceleration * shape);
  }
  return motion;
}

}  // namespace mjdiag
