#include "mjdiag/studies/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using test::MessageOf;

constexpr double kSampleTime = 1.0 / 8000.0;

VectorXd Sine(Index samples, double amplitude, double frequency) {
  return VectorXd::NullaryExpr(samples, [=](Index k) {
    return amplitude * std::sin(2.0 * std::numbers::pi * frequency * kSampleTime *
                                static_cast<double>(k));
  });
}

VectorXd Noise(Index samples, double sd) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> gaussian(0.0, sd);
  return VectorXd::NullaryExpr(samples, [&](Index) { return gaussian(random); });
}

Record RecordOf(const VectorXd& samples) {
  Record record(kSampleTime);
  record.Add({"x", "m", samples});
  return record;
}

/// The feature "x.<name>" of a record with one channel "x".
double Feature(const VectorXd& samples, const std::string& name) {
  const Record record = RecordOf(samples);
  const std::vector<std::string> names = FeatureNames(record, {"x"});
  const auto found = std::find(names.begin(), names.end(), "x." + name);
  if (found == names.end()) {
    ADD_FAILURE() << "no feature " << name;
    return 0.0;
  }
  return Features(record, {"x"})[found - names.begin()];
}

TEST(Features, AreThoseOfASine) {
  // 375 Hz: bin 96 of 3.90625 Hz; whole periods in 64 samples, which hit the peak.
  const VectorXd sine = Sine(8192, 3.0, 375.0);
  const double pi = std::numbers::pi;
  // 64 equidistant phases: mean |sin| = cot(pi / 64) / 32, close to 2 / pi.
  const double mean_size = 1.0 / (32.0 * std::tan(pi / 64.0));
  EXPECT_NEAR(Feature(sine, "mean"), 0.0, 1e-9);
  EXPECT_NEAR(Feature(sine, "log_rms"), std::log10(3.0 / std::sqrt(2.0)), 1e-9);
  EXPECT_NEAR(Feature(sine, "log_sd"), std::log10(3.0 / std::sqrt(2.0)), 1e-9);
  EXPECT_NEAR(Feature(sine, "log_peak"), std::log10(3.0), 1e-9);
  EXPECT_NEAR(Feature(sine, "log_peak_to_peak"), std::log10(6.0), 1e-9);
  EXPECT_NEAR(Feature(sine, "crest"), std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(Feature(sine, "kurtosis"), 1.5, 1e-9);
  EXPECT_NEAR(Feature(sine, "skewness"), 0.0, 1e-9);
  EXPECT_NEAR(Feature(sine, "shape_factor"), std::sqrt(0.5) / mean_size, 1e-9);
  EXPECT_NEAR(Feature(sine, "impulse_factor"), 1.0 / mean_size, 1e-9);
  EXPECT_NEAR(Feature(sine, "centroid"), 375.0, 1e-6);
  EXPECT_NEAR(Feature(sine, "dominant"), 375.0, 1e-9);
  // A Hann window spreads the power 1 : 4 : 1 over three bins.
  EXPECT_NEAR(Feature(sine, "spread"), 3.90625 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(Feature(sine, "log_power_250-500_Hz"), std::log10(4.5), 1e-9);
  EXPECT_LT(Feature(sine, "log_power_125-250_Hz"), -20.0);
  EXPECT_LT(Feature(sine, "log_power_500-1000_Hz"), -20.0);
}

TEST(Features, AreThoseOfWhiteNoise) {
  // Bounds: five standard deviations. Over N samples of Gaussian noise the mean has
  // variance v / N, skewness 6 / N, kurtosis 24 / N; a ratio to the rms about 1 / N.
  const Index n = 40000;
  const double root = std::sqrt(static_cast<double>(n));
  const VectorXd noise = Noise(n, 2.0);
  EXPECT_NEAR(Feature(noise, "mean"), 0.0, 5.0 * 2.0 / root);
  EXPECT_NEAR(Feature(noise, "skewness"), 0.0, 5.0 * std::sqrt(6.0) / root);
  EXPECT_NEAR(Feature(noise, "kurtosis"), 3.0, 5.0 * std::sqrt(24.0) / root);
  EXPECT_NEAR(Feature(noise, "shape_factor"), std::sqrt(std::numbers::pi / 2.0),
              5.0 / root);
  // A flat density up to 4 kHz: uniform, mean 2000 and sd 4000 / sqrt(12). The mean of
  // the frequency over about n / 2 independent bins has sd 1155 / sqrt(n / 2).
  EXPECT_NEAR(Feature(noise, "centroid"), 2000.0, 5.0 * 1155.0 * std::sqrt(2.0) / root);
  EXPECT_NEAR(Feature(noise, "spread"), 4000.0 / std::sqrt(12.0),
              5.0 * 1155.0 * std::sqrt(2.0) / root);
  // A band of the part w of all bins holds the part w of the variance; about 0.9 w n /
  // 2 independent bins give it a relative sd of sqrt(2 / (0.9 w n)).
  const std::vector<std::pair<std::string, double>> bands = {{"2000-4000", 0.5},
                                                             {"1000-2000", 0.25},
                                                             {"500-1000", 0.125},
                                                             {"250-500", 0.0625}};
  for (const auto& [band, part] : bands) {
    const double power = std::pow(10.0, Feature(noise, "log_power_" + band + "_Hz"));
    const double sd = std::sqrt(2.0 / (0.9 * part * static_cast<double>(n)));
    EXPECT_NEAR(power / (4.0 * part), 1.0, 5.0 * sd) << band;
  }
}

TEST(Features, BandsHoldTheWholePowerOnce) {
  // Also where band edges fall on no bin, on some, and on all.
  const VectorXd noise = Noise(4000, 1.0);
  for (const Index segment : {64, 600, 1000, 1001, 1999, 2000}) {
    const FeatureOptions options{.segment = segment, .bands = 6};
    const Record record = RecordOf(noise);
    const VectorXd features = Features(record, {"x"}, options);
    const std::vector<std::string> names = FeatureNames(record, {"x"}, options);
    const FeatureOptions one_band{.segment = segment, .bands = 1};
    const VectorXd whole = Features(record, {"x"}, one_band);
    const std::vector<std::string> whole_names = FeatureNames(record, {"x"}, one_band);
    double sum = 0.0;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k].find("log_power") == std::string::npos) continue;
      sum += std::pow(10.0, features[static_cast<Index>(k)]);
    }
    const auto total =
        std::find(whole_names.begin(), whole_names.end(), "x.log_power_0-4000_Hz");
    ASSERT_NE(total, whole_names.end());
    EXPECT_NEAR(std::log10(sum), whole[total - whole_names.begin()], 1e-9) << segment;
  }
}

TEST(Features, ChangeByAConstantWithTheUnit) {
  const VectorXd meters = Noise(4096, 1e-6).array() + 3e-6;
  const Record in_meters = RecordOf(meters);
  const Record in_nanometers = RecordOf(1e9 * meters);
  const VectorXd difference =
      Features(in_nanometers, {"x"}) - Features(in_meters, {"x"});
  const std::vector<std::string> names = FeatureNames(in_meters, {"x"});
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == "x.mean") continue;
    double expected = 0.0;
    if (names[k].starts_with("x.log_")) expected = 9.0;
    if (names[k].starts_with("x.log_power_")) expected = 18.0;
    EXPECT_NEAR(difference[static_cast<Index>(k)], expected, 1e-9) << names[k];
  }
}

TEST(Features, AreFiniteForConstantAndExtremeSignals) {
  for (const double value : {0.0, 0.1, -7.0, 1e-320, 1e300, -1e308}) {
    const Record record = RecordOf(VectorXd::Constant(5000, value));
    EXPECT_TRUE(Features(record, {"x"}).allFinite()) << value;
  }
  EXPECT_TRUE(Features(RecordOf(Sine(5000, 1e300, 375.0)), {"x"}).allFinite());
  EXPECT_TRUE(Features(RecordOf(Sine(5000, 1e-310, 375.0)), {"x"}).allFinite());
}

TEST(Features, OfAConstantAreThoseOfNoVariation) {
  const VectorXd constant = VectorXd::Constant(5000, 0.1);
  EXPECT_DOUBLE_EQ(Feature(constant, "mean"), 0.1);
  EXPECT_DOUBLE_EQ(Feature(constant, "log_sd"), -14.0);
  EXPECT_DOUBLE_EQ(Feature(constant, "crest"), 1.0);
  EXPECT_EQ(Feature(constant, "skewness"), 0.0);
  EXPECT_EQ(Feature(constant, "kurtosis"), 3.0);
  EXPECT_EQ(Feature(constant, "centroid"), 0.0);
  EXPECT_EQ(Feature(VectorXd::Zero(5000), "crest"), 1.0);
}

Record ClosedLoopRecord() {
  // 3968 samples of 62 whole groups of periods, the rest constant: known mean and peak.
  Record record(kSampleTime);
  VectorXd ripple = VectorXd::Constant(4000, 2.5e-6);
  ripple.head(3968) = Sine(3968, 1e-6, 375.0);
  record.Add({"x", "m", Noise(4000, 1e-3)});
  record.Add({"x_ref", "m", Noise(4000, 1e-3) + ripple});
  record.Add({"u_x", "N", Noise(4000, 10.0)});
  return record;
}

TEST(Features, SeeTheTrackingErrorWhereThereIsAReference) {
  const Record record = ClosedLoopRecord();
  const VectorXd features = Features(record, {"x", "u_x"});
  const std::vector<std::string> names = FeatureNames(record, {"x", "u_x"});
  const auto error = std::find(names.begin(), names.end(), "x_error.log_peak");
  ASSERT_NE(error, names.end());
  EXPECT_NEAR(features[error - names.begin()], std::log10(2.5e-6), 1e-9);
  EXPECT_EQ(std::find(names.begin(), names.end(), "u_x_error.log_peak"), names.end());
  const auto mean = std::find(names.begin(), names.end(), "x_error.mean");
  ASSERT_NE(mean, names.end());
  EXPECT_NEAR(features[mean - names.begin()], 2e-8, 1e-16);
  const std::vector<std::string> without =
      FeatureNames(record, {"x", "u_x"}, {.tracking_errors = false});
  EXPECT_EQ(3 * without.size(), 2 * names.size());
}

TEST(FeatureNames, NameEveryFeatureOnce) {
  const Record record = ClosedLoopRecord();
  const std::vector<std::string> channels = {"u_x", "x"};
  for (const FeatureOptions& options :
       {FeatureOptions{}, FeatureOptions{.segment = 100, .bands = 6},
        FeatureOptions{.bands = 1, .tracking_errors = false}}) {
    const std::vector<std::string> names = FeatureNames(record, channels, options);
    EXPECT_EQ(std::ssize(names), Features(record, channels, options).size());
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
    EXPECT_EQ(names.front(), "u_x.mean");
  }
}

TEST(Features, SayWhatIsWrongWithTheInput) {
  const Record record = ClosedLoopRecord();
  const auto message = [&](const std::vector<std::string>& channels,
                           const FeatureOptions& options) {
    return MessageOf<InputError>([&] { Features(record, channels, options); });
  };
  EXPECT_EQ(message({}, {}), "features: no channels; expected the names of some");
  EXPECT_EQ(message({"v"}, {}),
            "record: no channel \"v\"; expected one of x, x_ref, u_x");
  EXPECT_EQ(message({"x"}, {.segment = 5000}),
            "spectrum: segments of 5000 samples; expected 2 to the signal's 4000");
  const std::string bands =
      "; expected at least one band, and for n bands at least 2^n samples";
  EXPECT_EQ(message({"x"}, {.segment = 255, .bands = 8}),
            "features: 8 octave bands of segments of 255 samples" + bands);
  EXPECT_EQ(message({"x"}, {.bands = 0}),
            "features: 0 octave bands of segments of 2048 samples" + bands);
  EXPECT_EQ(message({"x"}, {.segment = -5}),
            "features: 9 octave bands of segments of -5 samples" + bands);
  EXPECT_EQ(message({"x"}, {.bands = 65}),
            "features: 65 octave bands of segments of 2048 samples" + bands);
  EXPECT_NO_THROW(Features(record, {"x"}, {.segment = 256, .bands = 8}));
}

TEST(Features, SayWhereAValueIsNotFinite) {
  for (const char* bad : {"x", "x_ref"}) {
    Record record(kSampleTime);
    for (const char* name : {"x", "x_ref"}) {
      VectorXd samples = VectorXd::Zero(4000);
      if (std::string(name) == bad) {
        samples[800] = std::numeric_limits<double>::quiet_NaN();
      }
      record.Add({name, "m", samples});
    }
    EXPECT_EQ(MessageOf<InputError>([&] { Features(record, {"x"}); }),
              "features: channel \"" + std::string(bad) +
                  "\" is nan at 0.100000 s; expected finite values");
  }
}

}  // namespace
}  // namespace mjdiag
