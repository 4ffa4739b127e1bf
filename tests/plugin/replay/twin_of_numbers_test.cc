// The twin of a plant with numbers of every kind: how what it reads changes with each.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/replay/plant_twin.h"
#include "support/numbered_plant.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kTicks = 240;
constexpr Index kBlock = 8;

/// Readings without a gain, and what they change with.
VectorXd Predicted(PlantTwin& twin, const VectorXd& theta, MatrixXd* sensitivities) {
  VectorXd readings(3 * kTicks);
  if (sensitivities != nullptr) sensitivities->resize(3 * kTicks, theta.size());
  VectorXd reading(3);
  const VectorXd none = VectorXd::Zero(3);
  twin.Start(theta);
  for (Index k = 0; k < kTicks; ++k) {
    twin.Predict(reading);
    readings.segment(3 * k, 3) = reading;
    const double t = 0.002 * static_cast<double>(k);
    const Eigen::Vector4d inputs(3.0 * std::sin(9.0 * t), 1.0 + std::cos(7.0 * t),
                                 0.04 * std::sin(11.0 * t), 0.05 * std::sin(5.0 * t));
    twin.Step({inputs.data(), 4}, none);
    if ((k + 1) % kBlock != 0) continue;
    const MatrixXd& of_block = twin.EndBlock();
    if (sensitivities == nullptr) continue;
    sensitivities->middleRows(3 * (k + 1 - kBlock), 3 * kBlock) = of_block;
  }
  return readings;
}

void ExpectFirstOrder(const Machine& machine, const UncertaintyOptions& options,
                      const std::vector<std::string>& among) {
  const UncertainMachine uncertain = MakeUncertainMachine(machine, options);
  std::vector<std::string> names;
  for (const Unknown& unknown : uncertain.unknowns) names.push_back(unknown.name);
  EXPECT_THAT(names, testing::IsSupersetOf(among));
  PlantTwin twin(machine, uncertain,
                 {{MatrixXd::Zero(6, 3), MatrixXd::Identity(3, 3), 0}}, kBlock);
  const VectorXd theta = VectorXd::Zero(twin.unknowns());
  MatrixXd sensitivities;
  Predicted(twin, theta, &sensitivities);
  for (Index i = 0; i < std::ssize(uncertain.unknowns); ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (!std::ranges::count(among, name)) continue;
    constexpr double kStep = 1e-4;
    const VectorXd step = kStep * VectorXd::Unit(theta.size(), i);
    const VectorXd difference = (Predicted(twin, theta + step, nullptr) -
                                 Predicted(twin, theta - step, nullptr)) /
                                (2.0 * kStep);
    EXPECT_LT((sensitivities.col(i) - difference).norm(), 0.15 * difference.norm())
        << name << " " << difference.norm();
  }
}

const std::vector<std::string> kNewKinds = {"gain@volts",
                                            "kp@servo",
                                            "kp@drive",
                                            "kv@drive",
                                            "tendon_stiffness@cable",
                                            "gear@volts",
                                            "tendon_damping@cable",
                                            "ref@slide"};

test::MjcfValues Smooth() {
  test::MjcfValues smooth = test::kNumberedValues;
  smooth["friction@shoulder"] = smooth["tendon_friction@rope"] = "0";
  return smooth;
}

TEST(TwinOfNumbers, KnowsWhatDrivesAndTendonsDo) {
  const Machine machine = test::NumberedMachine(
      Smooth(), R"(<custom><numeric name="known.ref@slide" data="0.01"/></custom>)");
  ExpectFirstOrder(machine, {.faults = false, .unmeasured = true, .start_energy = 0.0},
                   kNewKinds);
}

TEST(TwinOfNumbers, KnowsTheFrictionOfATendonThatSlidesAndSticks) {
  test::MjcfValues value = Smooth();
  value["tendon_friction@rope"] = "0.02";
  ExpectFirstOrder(test::NumberedMachine(value),
                   {.faults = false, .unmeasured = true, .start_energy = 0.0},
                   {"tendon_friction@rope", "kp@servo"});
}

TEST(TwinOfNumbers, HasThemAsFaults) {
  const Machine machine =
      test::NumberedMachine(Smooth(),
                            R"(<custom><numeric name="known" data="0"/>
         <text name="fault.heavy" data="mass fore"/>
         <text name="fault.volts" data="gain volts"/>
         <text name="fault.cable" data="tendon_stiffness cable"/></custom>)");
  ExpectFirstOrder(machine, {.start_energy = 0.0}, {"heavy", "volts", "cable"});
}

}  // namespace
}  // namespace mjdiag
