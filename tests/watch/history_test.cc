#include "mjdiag/watch/judge/history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/message_of.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;

constexpr double kStart = 1.7e9;
const std::vector<std::string> kQuantities = {"residual", "zeta", "zeta sd"};

void Add(History& history, double time, float residual, float zeta = 1.0F) {
  const std::vector<HistoryValue> values = {
      {-residual, 0.0F, residual}, {zeta, zeta, zeta}, {0.1F, 0.1F, 0.1F}};
  history.Add(time, values);
}

TEST(HistoryTest, KeepsTheExtremesOfASingleLookAtEveryLevel) {
  History history(kQuantities);
  for (int k = 0; k < 20000; ++k) {
    Add(history, kStart + 0.1 * k, k == 12345 ? 50.0F : 1.0F);
  }
  for (std::size_t level = 0; level < kHistoryLevels.size(); ++level) {
    float most = 0.0F;
    for (const HistoryRow& row : history.Rows(level)) {
      most = std::max(most, row.values[0].most);
    }
    EXPECT_EQ(most, 50.0F) << "level " << level;
  }
}

TEST(HistoryTest, MeansAreThoseOfAllLooks) {
  History history(kQuantities);
  for (int k = 0; k < 10; ++k) {
    Add(history, kStart + 0.1 * k, 1.0F, static_cast<float>(k));
  }
  EXPECT_FLOAT_EQ(history.Rows(0)[0].values[1].mean, 4.5F);
  EXPECT_EQ(history.Rows(0)[0].looks, 10U);
}

TEST(HistoryTest, AMonthIsLight) {
  History history(kQuantities);
  // Every ten seconds, which fills all levels as ten times a second does.
  for (int k = 0; k < 8640 * 45; ++k) Add(history, kStart + 10.0 * k, 1.0F);
  EXPECT_EQ(history.Rows(3).size(), kHistoryLevels[3].rows + 1);
  EXPECT_LT(history.ToBytes({}).size(), 1'000'000U);
  const double reach = history.Rows(3).back().time - history.Rows(3).front().time;
  EXPECT_GT(reach, 30 * 86400.0);
}

TEST(HistoryTest, ValuesThatAreNotKnownAreLeftOut) {
  History history(kQuantities);
  Add(history, kStart, 1.0F, std::nanf(""));
  Add(history, kStart + 0.1, 1.0F, 2.0F);
  EXPECT_EQ(history.Rows(0)[0].values[1].mean, 2.0F);
  Add(history, kStart + 1.0, 1.0F, std::nanf(""));
  EXPECT_TRUE(std::isnan(history.Rows(0)[1].values[1].mean));
}

TEST(HistoryTest, GoesOnWhereItWasWritten) {
  History history(kQuantities);
  for (int k = 0; k < 5000; ++k) {
    Add(history, kStart + 0.1 * k, 1.0F, static_cast<float>(k));
  }
  History again(kQuantities);
  const nlohmann::json kept = again.Restore(history.ToBytes({{"verdict", 7}}), "file");
  EXPECT_EQ(kept["verdict"], 7);
  for (int k = 5000; k < 9000; ++k) {
    Add(history, kStart + 0.1 * k, 1.0F, static_cast<float>(k));
    Add(again, kStart + 0.1 * k, 1.0F, static_cast<float>(k));
  }
  for (std::size_t level = 0; level < kHistoryLevels.size(); ++level) {
    const std::vector<HistoryRow> rows = history.Rows(level);
    const std::vector<HistoryRow> others = again.Rows(level);
    ASSERT_EQ(rows.size(), others.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      EXPECT_EQ(rows[k].time, others[k].time);
      EXPECT_EQ(rows[k].looks, others[k].looks);
      EXPECT_NEAR(rows[k].values[1].mean, others[k].values[1].mean, 1e-3);
    }
  }
}

TEST(HistoryTest, WhatLiesBehindAClockThatWasSetBackIsDropped) {
  History history(kQuantities);
  for (int k = 0; k < 100; ++k) Add(history, kStart + k, 1.0F);
  Add(history, kStart + 50, 1.0F);
  const std::vector<HistoryRow> rows = history.Rows(0);
  EXPECT_EQ(rows.back().time, kStart + 50);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_LT(rows[k - 1].time, rows[k].time);
  }
}

TEST(HistoryTest, RefusesBytesThatAreNoneOfItsOwn) {
  History history(kQuantities);
  Add(history, kStart, 1.0F);
  const std::string bytes = history.ToBytes({});
  const auto refusal = [&](const std::string& file) {
    History other(kQuantities);
    return test::MessageOf<InputError>([&] { other.Restore(file, "a file"); });
  };
  EXPECT_THAT(refusal("PK\x03\x04"), HasSubstr("a file: another file; expected"));
  EXPECT_THAT(refusal(bytes.substr(0, bytes.size() - 3)), HasSubstr("cut off"));
  std::string damaged = bytes;
  damaged[damaged.size() - 20] ^= 1;
  EXPECT_THAT(refusal(damaged), HasSubstr("damaged"));
  History other({"residual"});
  EXPECT_THROW(other.Restore(bytes, "a file"), OtherHistory);
}

}  // namespace
}  // namespace mjdiag
