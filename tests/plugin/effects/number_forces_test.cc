// What a number of a plant does along a motion, against inverse dynamics of two plants.

#include "mjdiag/plugin/effects/number_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mjdiag/plugin/effects/fault_effect.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "support/numbered_plant.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSamples = 16;

ObservedMotion AnyMotion(const Machine& machine) {
  const mjModel& plant = machine.plant();
  ObservedMotion motion;
  motion.sample_time = machine.rates().tick();
  motion.time = VectorXd::LinSpaced(kSamples, 0.0, 1.0);
  motion.position = 0.2 * MatrixXd::Random(plant.nv, kSamples);
  motion.velocity = MatrixXd::Random(plant.nv, kSamples);
  motion.own_acceleration = 5.0 * MatrixXd::Random(plant.nv, kSamples);
  motion.acceleration = motion.own_acceleration;
  motion.inputs = MatrixXd::Random(plant.nu, kSamples);
  motion.outputs = motion.position;
  return motion;
}

/// Force of all that acts beyond what the motion takes, where nothing sticks.
VectorXd BalanceOf(const mjModel& plant, const VectorXd& qpos0,
                   const ObservedMotion& motion, Index k) {
  const DataPtr data = MakeData(plant);
  VectorXd::Map(data->qpos, plant.nv) = qpos0 + motion.position.col(k);
  VectorXd::Map(data->qvel, plant.nv) = motion.velocity.col(k);
  VectorXd::Map(data->qacc, plant.nv) = motion.own_acceleration.col(k);
  VectorXd::Map(data->ctrl, plant.nu) = motion.inputs.col(k);
  mj_inverse(&plant, data.get());
  mj_fwdActuation(&plant, data.get());
  return VectorXd::Map(data->qfrc_actuator, plant.nv) -
         VectorXd::Map(data->qfrc_inverse, plant.nv);
}

TEST(ForceOfANumber, IsTheDerivativeOfInverseDynamics) {
  test::MjcfValues smooth = test::kNumberedValues;
  smooth["friction@shoulder"] = smooth["tendon_friction@rope"] = "0";
  const Machine machine = test::NumberedMachine(smooth);
  const mjModel& plant = machine.plant();
  const ObservedMotion motion = AnyMotion(machine);
  const VectorXd qpos0 = VectorXd::Map(plant.qpos0, plant.nv);
  for (const auto& [name, value] : smooth) {
    const ModelParameter number = FindModelParameter(plant, name);
    if (IsFriction(number.kind)) continue;
    const MatrixXd force = NumberForce(plant, machine.actuator_addresses(), number,
                                       motion, VectorXd::Zero(plant.nv));
    constexpr double kStep = 1e-4;
    const ModelPtr more = CopyModel(plant);
    const ModelPtr less = CopyModel(plant);
    ScaleNumbers(*more, {{number, std::exp(kStep)}});
    ScaleNumbers(*less, {{number, std::exp(-kStep)}});
    for (Index k = 0; k < kSamples; ++k) {
      const VectorXd difference =
          (BalanceOf(*more, qpos0, motion, k) - BalanceOf(*less, qpos0, motion, k)) /
          (2.0 * kStep);
      EXPECT_GT(difference.norm(), 1e-4) << name;
      EXPECT_LT((force.row(k).transpose() - difference).norm(),
                1e-6 * difference.norm())
          << name;
    }
  }
}

TEST(ForceOfANumber, OfDryFrictionPullsATendonBackWhereItSlides) {
  const Machine machine = test::NumberedMachine();
  const mjModel& plant = machine.plant();
  const ObservedMotion motion = AnyMotion(machine);
  const VectorXd still = VectorXd::Constant(plant.nv, 0.05);
  const MatrixXd force = NumberForce(
      plant, {}, FindModelParameter(plant, "tendon_friction@rope"), motion, still);
  const Eigen::Vector3d moment(1.0, 0.0, -0.5);
  int sliding = 0;
  for (Index k = 0; k < kSamples; ++k) {
    const double rate = moment.dot(motion.velocity.col(k));
    const bool slides = std::abs(rate) >= 0.05 * 1.5;
    sliding += slides;
    const Eigen::Vector3d expected =
        slides ? Eigen::Vector3d(-0.3 * std::copysign(1.0, rate) * moment)
               : Eigen::Vector3d::Zero();
    EXPECT_LT((force.row(k).transpose() - expected).norm(), 1e-12);
  }
  EXPECT_GT(sliding, 0);
}

// What a discovery tries of a fault parameter of any kind is what its numbers do together.
TEST(ForceOfANumber, IsWhatIsTriedOfAFaultParameter) {
  const Machine machine =
      test::NumberedMachine(test::kNumberedValues,
                            R"(<custom><text name="fault.a" data="mass upper fore"/>
         <text name="fault.b" data="kp drive"/>
         <text name="fault.c" data="tendon_stiffness cable"/>
         <text name="fault.d" data="armature shoulder"/></custom>)");
  const mjModel& plant = machine.plant();
  const ObservedMotion motion = AnyMotion(machine);
  const SiteMap map(plant, machine.linear(), machine.channels());
  const std::vector<FaultParameter> declared = FaultParameters(plant);
  const std::vector<PlacedEffect> faults = FaultEffects(plant);
  ASSERT_EQ(faults.size(), 4U);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const std::vector<Site> sites = faults[i].effect->CandidateSites(map);
    ASSERT_EQ(sites.size(), 1U) << faults[i].name();
    const std::vector<CandidateRegressor> trials =
        faults[i].effect->CandidateRegressors(
            {plant, machine.linear(), motion, sites.front()});
    ASSERT_EQ(trials.size(), 1U);
    MatrixXd together = MatrixXd::Zero(kSamples, plant.nv);
    for (const int id : declared[i].elements) {
      together += NumberForce(plant, machine.actuator_addresses(),
                              {declared[i].kind, id}, motion, VectorXd::Zero(plant.nv));
    }
    const MatrixXd tried = trials.front().signals * trials.front().entry.transpose();
    EXPECT_LT((tried - together).norm(), 1e-9 * together.norm()) << faults[i].name();
  }
}

}  // namespace
}  // namespace mjdiag
