#include "mjdiag/discovery/regression/whitening.h"

#include <gtest/gtest.h>

#include <random>

#include "support/followed_arm.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using test::FollowedArm;

Column SomeColumn(const FollowedArm& followed, unsigned seed, bool reading) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const auto signal = [&] {
    return VectorXd::NullaryExpr(followed.path.samples(),
                                 [&] { return normal(generator); })
        .eval();
  };
  Column column;
  column.forces = {{0, signal()}, {1, signal()}};
  if (reading) column.readings = {{1, 1e-4 * signal()}};
  return column;
}

TEST(Whitening, IsTheTransposeOfItsTransposed) {
  const FollowedArm followed({});
  const FilterPath& path = followed.path;
  const Whitening whitening(path, KeepGains(path));
  for (const bool reading : {false, true}) {
    const Column column = SomeColumn(followed, 1, reading);
    const VectorXd there = whitening.Of({&column}).col(0);
    const VectorXd u = VectorXd::LinSpaced(whitening.rows(), -1.0, 1.0).array().sin();
    const double back = whitening.TransposedTimes(u).front().Times(column);
    EXPECT_NEAR(u.dot(there), back, 1e-9 * u.norm() * there.norm());
  }
}

// A force that the arm has and the filter does not know of changes its innovations by W
// times that force.
TEST(Whitening, SaysWhatAForceLeavesInTheInnovations) {
  const FollowedArm without({}, 0.0);
  const FollowedArm with({"force_offset@elbow:force=0.01"}, 0.0);
  const MatrixXd inflation =
      MatrixXd::Ones(without.path.sensors(), without.path.samples());
  FilterNoise noise = without.path.noise;
  noise.size.setConstant(0.05);
  noise.white.setConstant(1e-3);
  const Whitening before(without.path, KeepGains(without.path, noise, inflation));
  const KeptGains after = KeepGains(with.path, noise, inflation);
  Column column;
  column.forces = {{1, VectorXd::Constant(without.path.samples(), 0.01)}};
  // A start at rest, where the force acts already, takes a while to be forgotten.
  const Index rows = before.rows() - 400;
  const VectorXd expected = before.Of({&column}).col(0).tail(rows);
  const VectorXd left = (after.left - before.gains().left).tail(rows);
  EXPECT_GT(expected.norm(), 0.1);
  EXPECT_LT((left - expected).norm(), 0.03 * expected.norm());
}

}  // namespace
}  // namespace mjdiag
