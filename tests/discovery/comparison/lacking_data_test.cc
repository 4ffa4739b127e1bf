// Real measurements with what real loggers lose compare as the whole ones do. The data
// belongs to its authors: MJDIAG_SERVO_DATA and MJDIAG_EMPS_DATA name its folders.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <sstream>

#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using testing::HasSubstr;
using testing::IsEmpty;

namespace fs = std::filesystem;

/// Columns of a file, the time first.
struct Columns {
  VectorXd time;
  std::vector<Channel> channels;

  VectorXd& operator[](const std::string& name) {
    for (Channel& channel : channels) {
      if (channel.name == name) return channel.samples;
    }
    throw std::out_of_range(name);
  }
};

Columns Open(const Record& record) { return {record.Time(), record.channels()}; }

void Save(const Columns& columns, const fs::path& file, Index lost_first,
          Index lost_count) {
  std::ostringstream text;
  text.precision(12);
  text << "time [s]";
  for (const Channel& channel : columns.channels) {
    text << "," << channel.name << " [" << channel.unit << "]";
  }
  for (Index k = 0; k < columns.time.size(); ++k) {
    if (k >= lost_first && k < lost_first + lost_count) continue;
    text << "\n" << columns.time[k];
    for (const Channel& channel : columns.channels) {
      text << ",";
      if (std::isfinite(channel.samples[k])) text << channel.samples[k];
    }
  }
  WriteTextFile(file, text.str() + "\n");
}

/// What stands in the file in the place of the whole record.
struct Defect {
  std::string note;
  std::function<void(Columns&, const std::string& reading)> put_in;
  Index lost_first = 0;
  Index lost_count = 0;
};

std::vector<Defect> Defects() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {
      {"1 gap of", [](Columns&, const std::string&) {}, 300, 12},
      {"has no value at",
       [nan](Columns& c, const std::string& q) {
         c[q].segment(400, 20).setConstant(nan);
         c[q].head(4).setConstant(nan);
         c[q].tail(5).setConstant(nan);
       }},
      {"has a new value only once in 4 samples",
       [](Columns& c, const std::string& q) {
         VectorXd& x = c[q];
         for (Index k = 0; k < x.size(); ++k) x[k] = x[k - k % 4];
       }},
      {"repeats values while in motion",
       [](Columns& c, const std::string& q) {
         std::mt19937_64 random(3);
         VectorXd& x = c[q];
         for (Index k = 1; k < x.size(); ++k) {
           if (random() % 16 == 0) x[k] = x[k - 1];
         }
       }},
      {"time stamps are irregular",
       [](Columns& c, const std::string& q) {
         std::mt19937_64 random(4);
         std::uniform_real_distribution<double> share(0.0, 0.3);
         const Columns whole = c;
         const double tick = c.time[1] - c.time[0];
         for (Index k = 1; k < c.time.size(); ++k) {
           const double early = share(random);
           c.time[k] -= early * tick;
           for (std::size_t i = 0; i < c.channels.size(); ++i) {
             const auto& [name, unit, x, measured] = whole.channels[i];
             if (name != q && name != q + "_ref") continue;  // inputs are held
             c.channels[i].samples[k] -= early * (x[k] - x[k - 1]);
           }
         }
       }},
  };
}

class LackingData : public testing::Test {
 protected:
  /// Whether there is such a file; else the test is skipped.
  static fs::path Find(const char* variable, const std::string& name) {
    const char* named = std::getenv(variable);
    const fs::path file = fs::path(named != nullptr ? named : "") / name;
    return fs::exists(file) ? file : fs::path();
  }
  /// @param accuracy  of the mean absolute error, of itself
  void ExpectAlike(mjdiag::Setup setup, const fs::path& file, double accuracy) const {
    const MeasuredFile whole = ReadMeasured(setup, file);
    EXPECT_THAT(whole.notes, IsEmpty());
    const Machine machine(setup);
    const double expected = Compare(machine, whole.record, {}).channels[0].mae;
    setup.record.reset();
    const std::string reading = setup.channels.sensors.front().channel;
    for (const Defect& defect : Defects()) {
      Columns columns = Open(whole.record);
      defect.put_in(columns, reading);
      Save(columns, folder_ / "r.csv", defect.lost_first, defect.lost_count);
      const MeasuredFile lacks = ReadMeasured(setup, folder_ / "r.csv");
      std::string notes;
      for (const std::string& note : lacks.notes) notes += note + "\n";
      EXPECT_THAT(notes, HasSubstr(defect.note));
      EXPECT_NEAR(Compare(machine, lacks.record, {}).channels[0].mae, expected,
                  accuracy * expected)
          << defect.note;
    }
  }
  const test::TemporaryFolder folder_;
};

TEST_F(LackingData, OfTheServoComparesAsTheWhole) {
  const fs::path file = Find("MJDIAG_SERVO_DATA", "sin_sin_kp200.csv");
  if (file.empty()) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no servo data";
    GTEST_SKIP() << "no servo data: MJDIAG_SERVO_DATA names no folder with the records";
  }
  ExpectAlike(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"), file, 0.05);
}

TEST_F(LackingData, OfEmpsComparesAsTheWhole) {
  const fs::path file = Find("MJDIAG_EMPS_DATA", "DATA_EMPS.mat");
  if (file.empty()) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no EMPS data";
    GTEST_SKIP() << "no EMPS data: MJDIAG_EMPS_DATA names no folder with DATA_EMPS.mat";
  }
  ExpectAlike(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"), file, 0.05);
}

}  // namespace
}  // namespace mjdiag
