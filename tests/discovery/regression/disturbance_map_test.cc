#include "mjdiag/discovery/regression/disturbance_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "mjdiag/plugin/replay/force_smoother.h"
#include "support/followed_arm.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using test::FollowedArm;

DisturbanceRows RowsOf(const FollowedArm& followed) {
  return {followed.path, SmoothForces(followed.path).value};
}

TEST(DisturbanceMap, IsTheTransposeOfItsTransposed) {
  const FollowedArm followed({});
  const DisturbanceRows rows = RowsOf(followed);
  const DisturbanceMap map(rows, DisturbanceMap::RestOf(rows));
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  Column column;
  for (Index dof = 0; dof < 2; ++dof) {
    column.forces.emplace_back(dof, VectorXd::NullaryExpr(followed.path.samples(), [&] {
                                 return normal(generator);
                               }));
  }
  for (Index sensor = 0; sensor < followed.path.sensors(); ++sensor) {
    column.readings.emplace_back(
        sensor, VectorXd::NullaryExpr(followed.path.samples(),
                                      [&] { return 1e-6 * normal(generator); }));
  }
  const VectorXd there = map.Of({&column}).col(0);
  const VectorXd u = VectorXd::LinSpaced(map.rows(), -1.0, 1.0).array().sin();
  const double back = map.TransposedTimes(u).front().Times(column);
  EXPECT_GT(there.norm(), 0.0);
  EXPECT_NEAR(u.dot(there), back, 1e-12 * u.norm() * there.norm());
}

// A force that lasts all the time, of which a latent force that lasts leaves the innovations
// nothing, has its size here, to a hundredth of what the filter has to find where it begins.
TEST(DisturbanceMap, HasAForceThatIsMissingInItsSize) {
  const FollowedArm without({}, 0.0);
  const FollowedArm with({"force_offset@elbow:force=0.01"}, 0.0);
  const DisturbanceRows rows_with = RowsOf(with);
  const DisturbanceRows rows_without = RowsOf(without);
  const DisturbanceMap::Rest rest = DisturbanceMap::RestOf(rows_with);
  const DisturbanceMap map(rows_with, rest);
  const DisturbanceMap before(rows_without, rest);
  Column column;
  column.forces = {{1, VectorXd::Constant(with.path.samples(), 0.01)}};
  const VectorXd one = map.Of({&column}).col(0);
  const VectorXd left = map.left() - before.left();
  EXPECT_NEAR(one.dot(left) / one.squaredNorm(), 1.0, 0.01);
}

// What a change of the velocity does in a tick is a force over the tick.
TEST(DisturbanceMap, TakesAChangeOfTheStateForTheForceThatMakesIt) {
  const FollowedArm followed({});
  const DisturbanceRows rows = RowsOf(followed);
  const DisturbanceMap map(rows, DisturbanceMap::RestOf(rows));
  const FilterPath& path = followed.path;
  Column force;
  force.forces = {{1, VectorXd::Ones(path.samples())}};
  Column change;
  const Index ns = path.tangents.front().A.rows();
  for (Index state = 0; state < ns; ++state) {
    VectorXd signal(path.samples());
    for (Index k = 0; k < path.samples(); ++k) signal[k] = path.At(k).B(state, 1);
    change.states.emplace_back(state, signal);
  }
  const VectorXd one = map.Of({&force}).col(0);
  const VectorXd other = map.Of({&change}).col(0);
  EXPECT_LT((one - other).norm(), 1e-9 * one.norm());
}

// A force moves what sticks by a fiftieth of what it moves elsewhere: what little such a joint
// does is no force fifty times as large.
TEST(DisturbanceMap, HasNoForceOfWhatSticks) {
  FilterPath path;
  path.sample_time = 1e-3;
  path.dofs = {0};
  path.first = {0};
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd C = Eigen::MatrixXd::Zero(1, 2);
  const Eigen::MatrixXd D = Eigen::MatrixXd::Zero(1, 1);
  path.tangents = {{A, Eigen::Vector2d(1e-6, 1e-3), C, D},
                   {A, Eigen::Vector2d(2e-8, 2e-5), C, D}};
  constexpr Index kSamples = 40;
  path.of_tick.assign(kSamples, 0);
  std::fill(path.of_tick.begin() + kSamples / 2, path.of_tick.end(), 1);
  path.innovations = Eigen::MatrixXd::Zero(1, kSamples);
  path.noise.reading = VectorXd::Ones(1);
  const DisturbanceRows rows(path, Eigen::MatrixXd::Ones(1, kSamples));
  const DisturbanceMap map(rows, {VectorXd::Ones(1), VectorXd::Ones(1)});
  Column change;
  change.states = {{1, VectorXd::Constant(kSamples, 2e-3)}};
  const VectorXd force = map.Of({&change}).col(0);
  ASSERT_EQ(force.size(), 2);
  // Along the velocity alone: what is missing of the position is a millionth.
  EXPECT_NEAR(force[0], 2.0, 1e-5);
  EXPECT_EQ(force[1], 0.0);
}

}  // namespace
}  // namespace mjdiag
