#include "mjdiag/plugin/design/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using testing::Each;
using testing::ElementsAre;

/// A bonder of which three numbers are not what its plant says.
class CalibrateTheBonder : public testing::Test {
 protected:
  CalibrateTheBonder() {
    const auto number = [this](const char* name) {
      return FindModelParameter(nominal_.plant(), name);
    };
    real_ = nominal_.WithNumbers({{number("damping@Y"), 1.2},
                                  {number("mass@y_stage"), 0.99},
                                  {number("stiffness@u4"), 1.05}});
  }

  Record Healthy(std::uint64_t seed) const {
    RunOptions options;
    options.seed = seed;
    return SimulateLinear(real_, DefaultMotion(nominal_.setup()), options);
  }

  /// From three healthy runs, once for all tests: it takes the longest.
  const CalibrationReport& Learned() const {
    static const CalibrationReport report =
        Calibrate(nominal_, {Healthy(1), Healthy(2), Healthy(3)},
                  {.linear = true, .progress = {}});
    return report;
  }

  const Machine nominal_ = test::Bonder();
  Machine real_ = nominal_;
};

TEST_F(CalibrateTheBonder, LearnsItsNumbersAndItsNoise) {
  const CalibrationReport& report = Learned();
  const Calibration& learned = report.calibration;
  const std::map<std::string, double> truth = {
      {"damping@Y", 1.2}, {"mass@y_stage", 0.99}, {"stiffness@u4", 1.05}};
  for (std::size_t i = 0; i < learned.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const auto moved = truth.find(learned.numbers[i]);
    const double expected = moved == truth.end() ? 1.0 : moved->second;
    // 29 numbers within 5 standard deviations: by chance outside with 2e-5.
    EXPECT_LT(std::abs(std::log(learned.factors[at] / expected)),
              5.0 * learned.Sd()[at])
        << learned.numbers[i];
  }
  EXPECT_EQ(learned.force_noise, 0.0);
  for (const double noise : learned.sensor_noise) EXPECT_NEAR(noise, 20e-9, 1e-9);
  for (const CalibratedRecord& record : report.records) EXPECT_LT(record.nis, 2.0);
}

TEST_F(CalibrateTheBonder, ThenNamesNothingThatIsHealthyAndEverythingThatIsNot) {
  mjdiag::Setup setup = nominal_.setup();
  setup.calibration = Learned().calibration;
  const Machine calibrated(setup);
  const auto reading = [&](const Machine& machine, std::uint64_t seed) {
    RunOptions options;
    options.seed = seed;
    const Record record = SimulateLinear(machine, DefaultMotion(setup), options);
    const Eigen::MatrixXd y = SamplesOf(record, nominal_.linear().outputs);
    const Eigen::MatrixXd u = SamplesOf(record, nominal_.linear().inputs);
    const auto twin = MakeTwinEstimator(calibrated, true);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      twin->Add({y.col(k).data(), 3}, {u.col(k).data(), 3});
    }
    twin->CatchUp();
    return twin->Read();
  };
  // A healthy run has something named with a probability of 1e-4.
  for (const std::uint64_t seed : {11, 12, 13, 14, 15}) {
    EXPECT_THAT(reading(real_, seed).named, Each(false)) << seed;
  }
  const TwinReading worn =
      reading(real_.With({{{"zeta_x", 1.0 + 1e-5}, {"eta_y", 1.0 - 1e-6}}, {}}), 16);
  EXPECT_THAT(worn.named,
              ElementsAre(true, false, false, false, false, true, false, false));
  EXPECT_NEAR(worn.deviation[0], 1e-5, 5.0 * worn.sd[0]);
  EXPECT_NEAR(worn.deviation[5], -1e-6, 5.0 * worn.sd[5]);
}

}  // namespace
}  // namespace mjdiag
