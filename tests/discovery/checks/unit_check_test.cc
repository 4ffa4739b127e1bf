#include "mjdiag/discovery/checks/unit_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "discovery/checks/checked_machine.h"
#include "mjdiag/discovery/checks/likeness.h"
#include "mjdiag/signals/record_file.h"
#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

using test::CheckedMachine;
using test::InputOf;
using test::Scaled;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kPerRad = 180.0 / std::numbers::pi;
constexpr double kTurn = 2.0 * std::numbers::pi;

class ClosedLoopUnits : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    machine_ = new CheckedMachine("emps", {"sensors.q.noise_sd=1e-8"});
    record_ = new Record(machine_->Run());
  }
  static void TearDownTestSuite() {
    delete record_;
    delete machine_;
  }
  static inline CheckedMachine* machine_ = nullptr;
  static inline Record* record_ = nullptr;
};

TEST_F(ClosedLoopUnits, OfAReadingAreRefusedByTheFactor) {
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "q", 1e3)),
              AllOf(HasSubstr("wrong units: 'q' reads 1000 times"),
                    HasSubstr("mm taken for m")));
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "q", 1e6)),
              HasSubstr("'q' reads 1000000 times"));
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "q_ref", 1e3)),
              HasSubstr("'q' reads 0.001 times its reference 'q_ref'"));
}

TEST_F(ClosedLoopUnits, OfAnInputAreRefusedByTheFactor) {
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "u", 1e3)),
              AllOf(HasSubstr("wrong units: 'u' reads 1000 times"),
                    HasSubstr("mV taken for V")));
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "u", 1e-3)),
              HasSubstr("'u' reads 0.001 times"));
}

TEST_F(ClosedLoopUnits, OfReadingAndReferenceAreRefused) {
  const Record record = Scaled(Scaled(*record_, "q", 1e3), "q_ref", 1e3);
  EXPECT_THAT(machine_->Refusal(record),
              AllOf(HasSubstr("'u' reads 0.001 times"), HasSubstr("'q' and 'q_ref'")));
}

TEST_F(ClosedLoopUnits, AndSignAreRefusedTogether) {
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "q", -1e3)),
              AllOf(HasSubstr("wrong units and sign: 'q' reads -1000 times"),
                    HasSubstr("mm taken for m and flipped")));
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "u", -1e3)),
              HasSubstr("wrong units and sign: 'u' reads -1000 times"));
}

TEST_F(ClosedLoopUnits, FlippedReadingOrReferenceIsRefused) {
  for (const char* channel : {"q", "q_ref"}) {
    EXPECT_THAT(machine_->Refusal(Scaled(*record_, channel, -1.0)),
                AllOf(HasSubstr("channel 'q' is about -1 times its reference 'q_ref'"),
                      HasSubstr("flipped sign of it, or of 'q_ref'?")))
        << channel;
  }
}

TEST_F(ClosedLoopUnits, FlippedInputIsRefused) {
  EXPECT_THAT(machine_->Refusal(Scaled(*record_, "u", -1.0)),
              AllOf(HasSubstr("channel 'u' is about -1 times what the controllers"),
                    HasSubstr("or of 'q' and 'q_ref'?")));
  const Record both = Scaled(Scaled(*record_, "q", -1.0), "q_ref", -1.0);
  EXPECT_THAT(machine_->Refusal(both), HasSubstr("channel 'u' is about -1 times"));
}

TEST_F(ClosedLoopUnits, FlippedSignIsSeenBesideStrongCauses) {
  for (const char* effect :
       {"coulomb_friction@load:force=60", "motor_constant@drive:factor=0.4",
        "linear_stiffness@load:stiffness=3000", "added_mass@load:mass=60"}) {
    const Record record = machine_->Run(effect);
    EXPECT_THAT(machine_->Refusal(Scaled(record, "q", -1.0)),
                HasSubstr("channel 'q' is about -1 times"))
        << effect;
    EXPECT_THAT(machine_->Refusal(Scaled(record, "u", -1.0)),
                HasSubstr("channel 'u' is about -1 times"))
        << effect;
  }
}

// Beyond its bandwidth a loop moves against its reference, with nothing flipped.
TEST(OutOfPhase, IsNotFlipped) {
  const CheckedMachine machine(
      "emps", {"axes.q.nested.position_gain=20", "axes.q.nested.velocity_gain=20"});
  constexpr Index kSamples = 10000;
  Record sine(machine.machine.rates().tick());
  sine.Add({"q_ref", "m", VectorXd::NullaryExpr(kSamples, [](Index k) {
              return 0.05 * std::sin(20.0 * 0.001 * static_cast<double>(k));
            })});
  sine.Add({"q", "m", VectorXd::Zero(kSamples)});
  const Record record = machine.Run(Replay(machine.machine.setup(), sine), "");
  ASSERT_LT(Liken(record.At("q").samples, record.At("q_ref").samples).correlation,
            -0.8);
  EXPECT_THAT(machine.Check(record), IsEmpty());
}

// A shaft that is stuck moves about a fiftieth of its reference, in rad.
TEST(StuckShaft, IsNotInDegrees) {
  const CheckedMachine machine("servo");
  const Record record = machine.Run("linear_stiffness@shaft:stiffness=22");
  const Likeness likeness = Liken(record.At("q").samples, record.At("q_ref").samples);
  ASSERT_GT(likeness.correlation, 0.9);
  ASSERT_NEAR(likeness.factor, 1.0 / kPerRad, 0.5 / kPerRad);
  EXPECT_NO_THROW(machine.Check(record));
  EXPECT_THAT(machine.Refusal(Scaled(machine.Run(), "q", 1.0 / kPerRad)),
              HasSubstr("'q' reads pi / 180 times"));
}

/// The voice coil under several sines, below and above its resonance at 13.8 Hz.
class OpenLoopUnits : public ::testing::Test {
 protected:
  Record Run(const std::string& effect) const {
    return machine_.Run(
        InputOf(machine_.machine, 20000,
                [](double t) {
                  return 0.2 * std::sin(1.3 * t) + 0.15 * std::sin(4.7 * t) +
                         0.05 * std::sin(11.0 * t) + 0.1 * std::sin(31.0 * t) +
                         0.1 * std::sin(130.0 * t);
                }),
        effect);
  }
  /// One sine of that frequency.
  Record RunAt(double hertz, const std::string& effect) const {
    return machine_.Run(
        InputOf(machine_.machine, 20000,
                [hertz](double t) { return 0.2 * std::sin(kTurn * hertz * t); }),
        effect);
  }
  const CheckedMachine machine_{"voice_coil"};
};

TEST_F(OpenLoopUnits, AreRefusedByTheFactor) {
  const Record record = Run("coulomb_friction@stage:force=0.3");
  EXPECT_THAT(machine_.Refusal(Scaled(record, "x", 1e3)),
              AllOf(HasSubstr("'x' reads 1000 times what the plant does"),
                    HasSubstr("mm taken for m, or 'i'")));
  EXPECT_THAT(machine_.Refusal(Scaled(record, "i", 1e3)),
              HasSubstr("'x' reads 0.001 times what the plant does"));
  EXPECT_THAT(machine_.Refusal(Scaled(record, "x", -1e3)),
              HasSubstr("wrong units and sign: 'x' reads -1000 times"));
}

TEST_F(OpenLoopUnits, FlippedSignIsRefused) {
  for (const char* effect :
       {"", "coulomb_friction@stage:force=0.3", "cubic_stiffness@stage:coefficient=4e6",
        "motor_constant@coil:factor=0.6"}) {
    const Record record = Run(effect);
    EXPECT_THAT(machine_.Check(record), IsEmpty()) << effect;
    for (const char* channel : {"x", "i"}) {
      EXPECT_THAT(machine_.Refusal(Scaled(record, channel, -1.0)),
                  AllOf(HasSubstr("channel 'x' is about -1 times what the plant does"),
                        HasSubstr("flipped sign of it, or of 'i'?")))
          << effect << ", " << channel;
    }
  }
}

// Between its resonance and that of its model a machine moves against its model.
TEST_F(OpenLoopUnits, AnotherResonanceIsNotFlipped) {
  const Record one = RunAt(30.0, "linear_stiffness@stage:stiffness=8000");
  const Record nominal = RunAt(30.0, "");
  EXPECT_LT(Liken(one.At("x").samples, nominal.At("x").samples).correlation, -0.8);
  EXPECT_THAT(machine_.Check(one), IsEmpty());
  EXPECT_THAT(machine_.Check(Run("linear_stiffness@stage:stiffness=8000")), IsEmpty());
}

// A mass that balances on a spring that pushes falls to the side that chance picks.
TEST(UnstablePlant, HasNoSign) {
  CheckedMachine buckled("voice_coil");
  buckled.machine =
      buckled.machine.With(test::With({"linear_stiffness@stage:stiffness=-950",
                                       "cubic_stiffness@stage:coefficient=1e8"}));
  const Excitation excitation = InputOf(buckled.machine, 20000, [](double t) {
    return 1e-3 * std::sin(kTurn * 0.7 * t) + 0.05 * std::sin(kTurn * 3.1 * t) +
           0.1 * std::sin(kTurn * 12.0 * t);
  });
  const Record record = buckled.Run(excitation, "");
  EXPECT_NO_THROW(buckled.Check(record));
  EXPECT_NO_THROW(buckled.Check(Scaled(record, "x", -1.0)));
}

TEST(Likeness, IsBroadOverOctavesOnly) {
  constexpr Index kSamples = 4000;
  VectorXd sine(kSamples);
  VectorXd chirp(kSamples);
  for (Index k = 0; k < kSamples; ++k) {
    const double t = static_cast<double>(k) / kSamples;
    sine[k] = std::sin(40.0 * kTurn * t);
    chirp[k] = std::sin(kTurn * (10.0 + 150.0 * t) * t);
  }
  const VectorXd noise = GaussianNoise(kSamples, 0.05, 3);
  const Likeness of_sine = Liken(-2.0 * sine + noise, sine);
  EXPECT_NEAR(of_sine.factor, 2.0, 0.02);
  EXPECT_LT(of_sine.correlation, -0.99);
  EXPECT_FALSE(of_sine.broad);
  EXPECT_TRUE(Liken(-2.0 * chirp + noise, chirp).broad);
  // Another one at high frequencies, as of a mass instead of a spring.
  VectorXd mass = chirp;
  for (Index k = 1; k + 1 < kSamples; ++k) {
    mass[k] = 300.0 * (2.0 * chirp[k] - chirp[k - 1] - chirp[k + 1]);
  }
  EXPECT_FALSE(Liken(mass, chirp).broad);
}

/// Every record of the servo, at its gain.
class MeasuredServoUnits : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* named = std::getenv("MJDIAG_SERVO_DATA");
    folder_ = named != nullptr ? named : "";
    if (std::filesystem::exists(folder_ / "sin_sin_kp100.csv")) return;
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no servo data in " << folder_;
    GTEST_SKIP() << "no servo data: MJDIAG_SERVO_DATA names no folder with them";
  }
  /// @param check  gets each record with its machine
  void ForEach(const std::function<void(const CheckedMachine&, const Record&,
                                        const std::string&)>& check) const {
    for (const char* gain : {"100", "200", "800"}) {
      const CheckedMachine machine(
          "servo", {"axes.q.feedback.numerator=[" + std::string(gain) + ".0]"});
      for (const char* motion :
           {"sin_sin", "sin_time_square", "up_and_down", "lift_and_drop"}) {
        const std::string file = std::string(motion) + "_kp" + gain + ".csv";
        check(machine, ReadRecord(folder_ / file, machine.machine.setup().record),
              file);
      }
    }
  }

  std::filesystem::path folder_;
};

TEST_F(MeasuredServoUnits, AreFine) {
  ForEach(
      [](const CheckedMachine& machine, const Record& record, const std::string& file) {
        EXPECT_THAT(machine.Check(record), IsEmpty()) << file;
      });
}

TEST_F(MeasuredServoUnits, InDegreesAreRefused) {
  ForEach(
      [](const CheckedMachine& machine, const Record& record, const std::string& file) {
        for (const char* channel : {"q", "q_ref"}) {
          EXPECT_THAT(machine.Refusal(Scaled(record, channel, kPerRad)),
                      HasSubstr(channel[1] == '\0' ? "'q' reads 180 / pi times"
                                                   : "'q' reads pi / 180 times"))
              << file;
        }
        EXPECT_THAT(machine.Refusal(Scaled(record, "q", -kPerRad)),
                    HasSubstr("'q' reads -180 / pi times"))
            << file;
      });
}

TEST_F(MeasuredServoUnits, FlippedAreRefused) {
  ForEach(
      [](const CheckedMachine& machine, const Record& record, const std::string& file) {
        EXPECT_THAT(machine.Refusal(Scaled(record, "q", -1.0)),
                    HasSubstr("channel 'q' is about -1 times"))
            << file;
        EXPECT_THAT(machine.Refusal(Scaled(record, "q_ref", -1.0)),
                    HasSubstr("channel 'q' is about -1 times"))
            << file;
        EXPECT_THAT(machine.Refusal(Scaled(record, "volts", -1.0)),
                    HasSubstr("channel 'volts' is about -1 times"))
            << file;
      });
}

// A gain that is not that of the record is not a flipped sign.
TEST_F(MeasuredServoUnits, AtAnotherGainAreNotRefused) {
  const CheckedMachine machine("servo");
  for (const char* file : {"up_and_down_kp800.csv", "up_and_down_kp100.csv"}) {
    EXPECT_NO_THROW(
        machine.Check(ReadRecord(folder_ / file, machine.machine.setup().record)))
        << file;
  }
}

}  // namespace
}  // namespace mjdiag
