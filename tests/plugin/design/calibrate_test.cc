#include "mjdiag/plugin/design/calibrate.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/runtime/simulation.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

/// A bonder of which three numbers are not what its plant says.
class CalibrateTheBonder : public testing::Test {
 protected:
  CalibrateTheBonder() {
    const auto number = [this](const char* name) {
      return FindPlantNumber(nominal_.plant(), name);
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

  const Machine nominal_ = test::Bonder();
  Machine real_ = nominal_;
};

TEST_F(CalibrateTheBonder, LearnsItsNumbersAndItsNoise) {
  const CalibrationReport report =
      Calibrate(nominal_, {Healthy(1), Healthy(2)}, {.linear = true, .progress = {}});
  const Calibration& learned = report.calibration;
  const std::map<std::string, double> truth = {
      {"damping@Y", 1.2}, {"mass@y_stage", 0.99}, {"stiffness@u4", 1.05}};
  for (std::size_t i = 0; i < learned.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const auto moved = truth.find(learned.numbers[i]);
    const double expected = moved == truth.end() ? 1.0 : moved->second;
    // 29 numbers within 5 standard deviations: by chance outside with 2e-5. Beyond 2e-5
    // the sensitivities of the twin, of the mean of a tick, are not exact.
    EXPECT_LT(std::abs(std::log(learned.factors[at] / expected)),
              2e-5 + 5.0 * std::sqrt(learned.covariance(at, at)))
        << learned.numbers[i];
  }
  EXPECT_EQ(learned.force_noise, 0.0);
  for (const double noise : learned.sensor_noise) EXPECT_NEAR(noise, 20e-9, 1e-9);
  for (const CalibratedRecord& record : report.records) EXPECT_LT(record.misfit, 2.0);
}

}  // namespace
}  // namespace mjdiag
