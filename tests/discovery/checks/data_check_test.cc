#include "mjdiag/discovery/checks/data_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>

#include "discovery/checks/checked_machine.h"
#include "mjdiag/discovery/checks/lag_trend.h"
#include "mjdiag/discovery/measurements.h"
#include "mjdiag/signals/record_file.h"
#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

using test::InputOf;
using test::Scaled;
using test::WithChanged;
using Subject = test::CheckedMachine;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Eigen::Index;
using Eigen::VectorXd;

/// What a clock records that gains `drift` samples over the record.
Record Drifting(const Record& record, const std::string& name, double drift) {
  return WithChanged(record, name, [&](VectorXd& x) {
    const VectorXd true_samples = x;
    const auto last = static_cast<double>(x.size() - 1);
    for (Index k = 0; k < x.size(); ++k) {
      const double at =
          std::clamp(static_cast<double>(k) * (1.0 + drift / last) - 0.5 * drift, 0.0,
                     last - 1e-6);
      const auto before = static_cast<Index>(at);
      const double share = at - static_cast<double>(before);
      x[k] = (1.0 - share) * true_samples[before] + share * true_samples[before + 1];
    }
  });
}

class EmpsRecord : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    subject_ = new Subject("emps", {"sensors.q.noise_sd=1e-8"});
    record_ = new Record(subject_->Run());
  }
  static void TearDownTestSuite() {
    delete record_;
    delete subject_;
  }
  static inline Subject* subject_ = nullptr;
  static inline Record* record_ = nullptr;
};

TEST_F(EmpsRecord, PassesWithoutANote) {
  EXPECT_THAT(subject_->Check(*record_), IsEmpty());
}

TEST_F(EmpsRecord, PassesWithWhateverCauseIsInIt) {
  for (const char* effect :
       {"coulomb_friction@load:force=0.2",
        "coulomb_friction@load:force=60",
        "stribeck_friction@load:coulomb=20,breakaway=40,velocity=0.005",
        "presliding_hysteresis@load:force=40,stiffness=1e6",
        "viscous_friction@load:coefficient=400",
        "force_offset@load:force=20",
        "force_ripple@load:amplitude=30,period=0.01",
        "motor_constant@drive:factor=0.4",
        "input_delay@drive:delay=0.004",
        "amplifier_lag@drive:time_constant=0.003",
        "force_saturation@drive:limit=2.5",
        "linear_stiffness@load:stiffness=3000",
        "added_mass@load:mass=60",
        "flexible_mode@load:mass=20,frequency=30,damping_ratio=0.02",
        "end_stop@load:position=0.15,stiffness=1e5",
        "floor_vibration@load:amplitude=20,frequency=0.7",
        "encoder_scale@load_encoder:factor=1.5",
        "encoder_periodic_error@load_encoder:amplitude=1e-4,period=0.01",
        "encoder_drift@load_encoder:rate=0.001",
        "encoder_noise@load_encoder:sd=1e-6"}) {
    const Record record = subject_->Run(effect);
    std::vector<std::string> notes;
    EXPECT_NO_THROW(notes = subject_->Check(record)) << effect;
    EXPECT_THAT(notes, IsEmpty()) << effect;
  }
}

TEST_F(EmpsRecord, WithTooFewSamplesIsRefused) {
  EXPECT_THAT(subject_->Refusal(record_->Slice(0, 100)),
              AllOf(HasSubstr("too short: 100 samples of which the first 49"),
                    HasSubstr("at least 64")));
}

TEST_F(EmpsRecord, WithSamplesThatAreNoNumbersIsRefused) {
  for (const std::string channel : {"q", "u", "q_ref"}) {
    const Record record = WithChanged(*record_, channel, [](VectorXd& x) {
      x[1234] = std::nan("");
      x[2000] = std::numeric_limits<double>::infinity();
    });
    EXPECT_THAT(subject_->Refusal(record),
                AllOf(HasSubstr("2 missing samples of '" + channel + "'"),
                      HasSubstr("sample 1234 (1.234 s)")));
  }
}

TEST_F(EmpsRecord, ThatHoldsOrLacksSamplesPassesWithoutThem) {
  const Record record = WithChanged(*record_, "q", [](VectorXd& x) {
    x.segment(1000, 7).setConstant(x[1000]);
    x.segment(3500, 40).setConstant(x[3500]);
    x[1234] = std::nan("");
  });
  const Measurements measurements = MeasurementsOf(subject_->machine, record, nullptr);
  const auto& [marked, machine, name, notes, own_plant] = measurements.fit.front();
  const SampleMask& measured = marked.At("q").measured;
  ASSERT_EQ(measured.size(), record.samples());
  EXPECT_EQ(record.samples() - measured.count(), 6 + 39 + 1);
  EXPECT_TRUE(measured[1000] && !measured[1001] && !measured[1234] && measured[3540]);
  EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("'q' has no value at 1 samples"),
                                          HasSubstr("'q' repeats values")));
  EXPECT_THAT(subject_->Check(marked), IsEmpty());
}

TEST_F(EmpsRecord, ThatLacksMostIsTooShort) {
  const Record record = WithChanged(*record_, "q", [](VectorXd& x) {
    for (Index k = 0; k < x.size(); ++k) {
      if (k % 500 != 0) x[k] = std::nan("");
    }
  });
  EXPECT_THAT(
      subject_->Refusal(
          MeasurementsOf(subject_->machine, record, nullptr).fit.front().record),
      AllOf(HasSubstr("too short: "), HasSubstr("values of 'q'")));
}

// At rest and slowly moving, a quantised sensor repeats its values without a fault.
TEST(QuantisedRecord, Passes) {
  const Subject subject("emps", {"sensors.q.resolution=1e-6"});
  for (const char* effect : {"", "coulomb_friction@load:force=20"}) {
    const Record record = subject.Run(effect);
    EXPECT_EQ(record.At("q").samples[2600], record.At("q").samples[2610]);
    EXPECT_THAT(subject.Check(record), IsEmpty()) << effect;
  }
}

TEST(QuantisedRecord, ThatSaturatesInMotionIsRefused) {
  const Subject subject("emps", {"sensors.q.resolution=1e-6"});
  const Record record =
      WithChanged(subject.Run(), "q", [](VectorXd& x) { x = x.cwiseMin(0.15); });
  EXPECT_THAT(subject.Refusal(record),
              HasSubstr("saturated: 'q' sits at exactly 0.15"));
}

TEST(QuantisedRecord, WithoutNoiseThatSaturatesAtRestPasses) {
  const Subject subject("emps", {"sensors.q.resolution=1e-6"});
  const double rest = subject.Run().At("q").samples[2600];
  const Record record = WithChanged(subject.Run(), "q",
                                    [&](VectorXd& x) { x = x.cwiseMin(rest - 1e-6); });
  EXPECT_THAT(subject.Check(record), IsEmpty());
}

TEST_F(EmpsRecord, WithASaturatedEncoderIsRefused) {
  const Record high =
      WithChanged(*record_, "q", [](VectorXd& x) { x = x.cwiseMin(0.15); });
  EXPECT_THAT(subject_->Refusal(high),
              HasSubstr("saturated: 'q' sits at exactly 0.15 m for "));
  const Record low =
      WithChanged(*record_, "q", [](VectorXd& x) { x = x.cwiseMax(0.02); });
  EXPECT_THAT(subject_->Refusal(low),
              HasSubstr("saturated: 'q' sits at exactly 0.02 m for "));
}

// The machine rests there as it should; only that the noise is gone tells.
TEST_F(EmpsRecord, ThatLosesItsNoiseAtTheEndOfTheStrokeIsRefused) {
  const double limit = record_->At("q").samples[2600] - 1e-6;
  const Record record =
      WithChanged(*record_, "q", [&](VectorXd& x) { x = x.cwiseMin(limit); });
  EXPECT_THAT(subject_->Refusal(record), HasSubstr("saturated: 'q'"));
}

// Noise of the motion, and an encoder whose step is larger than that, behind a filter.
TEST(RestingRecord, ThatRepeatsWhereverItRestsIsNotSaturated) {
  const Subject subject("emps");
  const Record record = WithChanged(subject.Run(), "q", [](VectorXd& x) {
    constexpr double kStep = 1.5e-6;
    const VectorXd noise = GaussianNoise(x.size(), 2e-8, 4);
    double filtered = x[0];
    for (Index k = 0; k < x.size(); ++k) {
      const double before = filtered;
      filtered += 0.7 * (kStep * std::round(x[k] / kStep) - filtered);
      const bool moves = std::abs(filtered - before) > 0.1 * kStep;
      x[k] = 1e-10 * std::round(1e10 * (filtered + (moves ? noise[k] : 0.0)));
    }
  });
  EXPECT_THAT(subject.Check(record), IsEmpty());
}

// It turns within a step of its encoder, whose readings are the same there and have noise
// elsewhere.
TEST_F(EmpsRecord, ThatTurnsAroundWithinAStepIsNotSaturated) {
  constexpr double kStep = 1.5e-6;
  constexpr Index kTop = 2600;
  constexpr Index kSide = 400;
  const VectorXd noise = GaussianNoise(record_->samples(), 1e-9, 4);
  const Record record = WithChanged(*record_, "q", [&](VectorXd& x) {
    const double top = x.maxCoeff() + 1e-4;
    for (Index k = kTop - kSide; k <= kTop + kSide; ++k) {
      const double away = 8e-10 * static_cast<double>((k - kTop) * (k - kTop));
      const double steps = std::round(away / kStep);
      x[k] = top - kStep * steps + (steps > 0.0 ? noise[k] : 0.0);
    }
  });
  EXPECT_THAT(subject_->Refusal(record), Not(HasSubstr("saturated")));
}

TEST(RestingRecord, OfAJointThatStandsStillIsNotSaturated) {
  const Subject subject("emps");
  for (const double step : {1e-4, 1e-7}) {
    const Record record = WithChanged(subject.Run(), "q", [&](VectorXd& x) {
      const VectorXd noise = GaussianNoise(x.size(), 0.4 * step, 4);
      for (Index k = 0; k < x.size(); ++k) {
        x[k] = 0.1 + step * std::round(noise[k] / step);
      }
    });
    EXPECT_THAT(subject.Refusal(record), Not(HasSubstr("saturated"))) << step;
  }
}

TEST_F(EmpsRecord, WithDriftingClocksIsRefused) {
  for (const double drift : {1.0, -1.0, 5.0}) {
    EXPECT_THAT(subject_->Refusal(Drifting(*record_, "q", drift)),
                AllOf(HasSubstr("clocks of 'q' and 'u' drift by "),
                      HasSubstr(drift == 5.0 ? "by 5.0 samples" : "by 1.0 samples")))
        << drift;
  }
  EXPECT_THAT(subject_->Refusal(Drifting(*record_, "u", 2.0)),
              HasSubstr("clocks of 'q' and 'u' drift by 2.0 samples"));
}

TEST_F(EmpsRecord, WithAConstantLagOrAQuarterSampleOfDriftPasses) {
  EXPECT_THAT(subject_->Check(Drifting(*record_, "q", 0.25)), IsEmpty());
  const Record late = WithChanged(*record_, "u", [](VectorXd& x) {
    x.tail(x.size() - 3) = x.head(x.size() - 3).eval();
  });
  EXPECT_THAT(subject_->Check(late), IsEmpty());
}

/// Under a chirp of 2 to 30 Hz, across the resonance at 13.8 Hz.
class OpenLoopRecord : public ::testing::Test {
 protected:
  Record Run(const std::string& effect = "") const {
    return subject_.Run(
        InputOf(subject_.machine, 20000,
                [](double t) {
                  return 0.3 * std::sin(2.0 * std::numbers::pi * (2.0 + 3.5 * t) * t);
                }),
        effect);
  }
  const Subject subject_{"voice_coil"};
};

TEST_F(OpenLoopRecord, PassesWithWhateverCauseIsInIt) {
  for (const char* effect :
       {"", "coulomb_friction@stage:force=0.3", "added_mass@stage:mass=0.03",
        "structural_stiffness@stage:factor=0.7",
        "viscous_friction@stage:coefficient=-2", "force_offset@stage:force=0.5",
        "motor_constant@coil:factor=0.5", "input_delay@coil:delay=0.002",
        "cubic_stiffness@stage:coefficient=1e7",
        "presliding_hysteresis@stage:force=1,stiffness=1e4",
        "encoder_drift@encoder:rate=1e-4"}) {
    const Record record = Run(effect);
    std::vector<std::string> notes;
    EXPECT_NO_THROW(notes = subject_.Check(record)) << effect;
    EXPECT_THAT(notes, IsEmpty()) << effect;
  }
}

TEST_F(OpenLoopRecord, WithDriftingClocksIsRefused) {
  EXPECT_THAT(subject_.Refusal(Drifting(Run(), "x", 3.0)),
              HasSubstr("clocks of 'x' and 'i' drift by 3."));
}

class BonderRecord : public ::testing::Test {
 protected:
  const Subject subject_{"ab383"};
};

TEST_F(BonderRecord, PassesWithAndWithoutCauses) {
  for (const char* effect :
       {"", "coulomb_friction@X:force=0.02", "coulomb_friction@X:force=40",
        "force_ripple@Y:amplitude=20,period=0.001", "input_delay@x_motor:delay=0.0002",
        "motor_constant@z_motor:factor=0.5",
        "floor_vibration@X:amplitude=30,frequency=33.3",
        "encoder_drift@x_encoder:rate=0.0001"}) {
    const Record record = subject_.Run(effect);
    std::vector<std::string> notes;
    EXPECT_NO_THROW(notes = subject_.Check(record)) << effect;
    EXPECT_THAT(notes, IsEmpty()) << effect;
  }
}

TEST_F(BonderRecord, InDegreesOrWithADriftingClockIsRefused) {
  const Record record = subject_.Run("coulomb_friction@X:force=20");
  const double degrees = 180.0 / std::numbers::pi;
  EXPECT_THAT(
      subject_.Refusal(Scaled(record, "z", degrees)),
      AllOf(HasSubstr("'z' reads 180 / pi times"), HasSubstr("degrees taken for rad")));
  EXPECT_THAT(subject_.Refusal(Scaled(Scaled(record, "z", degrees), "z_ref", degrees)),
              HasSubstr("'u_z' reads pi / 180 times"));
  EXPECT_THAT(subject_.Refusal(Drifting(record, "x", 2.0)),
              HasSubstr("clocks of 'x' and 'u_x' drift by "));
}

TEST(MeasuredEmpsRecord, PassesWithoutANote) {
  const char* named = std::getenv("MJDIAG_EMPS_DATA");
  const std::filesystem::path folder = named != nullptr ? named : "";
  if (!std::filesystem::exists(folder / "DATA_EMPS.mat")) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no EMPS data in " << folder;
    GTEST_SKIP() << "no EMPS data: MJDIAG_EMPS_DATA names no folder with DATA_EMPS.mat";
  }
  const Subject subject("emps");
  for (const char* file : {"DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"}) {
    const Record record = ReadRecord(folder / file, subject.machine.setup().record);
    EXPECT_THAT(subject.Check(record), IsEmpty()) << file;
    EXPECT_THAT(subject.Refusal(Drifting(record, "q", 3.0)), HasSubstr("clocks of 'q'"))
        << file;
    EXPECT_THAT(subject.Refusal(Scaled(record, "u", 1e3)),
                HasSubstr("'u' reads 1000 times"))
        << file;
  }
}

// A lag that shrinks as the motion gets faster is a phase error, not a clock.
TEST(LagTrend, IsNotTakenInByAPhaseErrorUnderAChirp) {
  constexpr Index kSamples = 20000;
  constexpr double kPhase = 0.3;
  VectorXd simulated(kSamples);
  VectorXd measured(kSamples);
  for (Index k = 0; k < kSamples; ++k) {
    const double t = static_cast<double>(k) / kSamples;
    const double phase = 2.0 * std::numbers::pi * (20.0 + 60.0 * t) * t;
    simulated[k] = std::sin(phase);
    measured[k] = std::sin(phase - kPhase);
  }
  measured += GaussianNoise(kSamples, 1e-4, 5);
  const auto trend = FindLagTrend(measured, simulated);
  if (trend) {
    EXPECT_EQ(ClockDrift(*trend, LagTrend{}), 0.0) << trend->drift;
  }
}

TEST(LagTrend, MeasuresADriftBeyondAnotherGainAndNoise) {
  constexpr Index kSamples = 10000;
  constexpr double kDrift = 2.5;
  VectorXd simulated(kSamples);
  VectorXd measured(kSamples);
  for (Index k = 0; k < kSamples; ++k) {
    const auto t = static_cast<double>(k);
    const double late = 1.5 + kDrift * (t / kSamples - 0.5);
    simulated[k] = std::sin(0.01 * t);
    measured[k] = 0.7 * std::sin(0.01 * (t - late)) + 1e-6 * t;
  }
  measured += GaussianNoise(kSamples, 1e-4, 6);
  const auto trend = FindLagTrend(measured, simulated);
  ASSERT_TRUE(trend.has_value());
  EXPECT_NEAR(trend->drift, kDrift, 4.0 * trend->sd + 0.02);
  EXPECT_NE(ClockDrift(*trend, LagTrend{}), 0.0);
}

}  // namespace
}  // namespace mjdiag
