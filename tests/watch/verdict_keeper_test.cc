#include "mjdiag/watch/judge/verdict_keeper.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace mjdiag {
namespace {

class VerdictKeeperTest : public testing::Test {
 protected:
  /// That many looks, a tenth of a second apart.
  /// @return when the verdict changed, in looks from the begin of the test; -1: never
  int Say(VerdictKind kind, int looks, const std::string& fault = "") {
    int changed = -1;
    for (int k = 0; k < looks; ++k) {
      Finding look;
      look.kind = kind;
      look.words = NameOf(kind);
      look.time = 1000.0 + 0.1 * looks_++;
      if (!fault.empty()) {
        FaultVerdict named;
        named.name = fault;
        named.deviation = 0.2;
        named.sd = 0.01;
        named.detected = true;
        look.result.faults = {named};
      }
      if (keeper_.Take(look)) changed = looks_ - 1;
    }
    return changed;
  }

  VerdictKeeper keeper_;
  int looks_ = 0;
};

TEST_F(VerdictKeeperTest, SaysTheFirstVerdictAtOnce) {
  EXPECT_EQ(Say(VerdictKind::kSettling, 5), -1);
  EXPECT_EQ(Say(VerdictKind::kHealthy, 1), 5);
}

TEST_F(VerdictKeeperTest, AnotherOneHasToStandForAMoment) {
  Say(VerdictKind::kHealthy, 10);
  EXPECT_EQ(Say(VerdictKind::kUnexplained, 2), -1);
  EXPECT_EQ(Say(VerdictKind::kHealthy, 10), -1);
  EXPECT_EQ(Say(VerdictKind::kFault, 10, "zeta"), 26);
  EXPECT_NEAR(keeper_.now().since, 1002.2, 1e-9);
}

TEST_F(VerdictKeeperTest, RemembersSinceWhenAnythingIsWrong) {
  Say(VerdictKind::kHealthy, 10);
  Say(VerdictKind::kResidual, 10);
  Say(VerdictKind::kFault, 10, "zeta");
  EXPECT_NEAR(keeper_.now().since, 1002.0, 1e-9);
  EXPECT_NEAR(keeper_.now().wrong_since, 1001.0, 1e-9);
  Say(VerdictKind::kHealthy, 100);
  EXPECT_EQ(keeper_.now().wrong_since, 0.0);
}

TEST_F(VerdictKeeperTest, ABetterOneHasToStandForLonger) {
  Say(VerdictKind::kFault, 10, "zeta");
  EXPECT_EQ(Say(VerdictKind::kHealthy, 20), -1);
  EXPECT_EQ(Say(VerdictKind::kHealthy, 20), 40);
}

TEST_F(VerdictKeeperTest, ARunThatBeginsDoesNotChangeIt) {
  Say(VerdictKind::kFault, 10, "zeta");
  Say(VerdictKind::kSettling, 100);
  EXPECT_EQ(keeper_.now().kind, VerdictKind::kFault);
  EXPECT_EQ(Say(VerdictKind::kFault, 10, "zeta"), -1);
  EXPECT_EQ(keeper_.now().since, 1000.0);
}

TEST_F(VerdictKeeperTest, GoesOnWithWhatWasSaidBefore) {
  Say(VerdictKind::kFault, 10, "zeta");
  VerdictKeeper next;
  next.Resume(VerdictFromJson(ToJson(keeper_.now())));
  Finding look;
  look.kind = VerdictKind::kFault;
  look.time = 5000.0;
  look.result.faults = keeper_.now().faults;
  EXPECT_FALSE(next.Take(look));
  EXPECT_EQ(next.now().since, 1000.0);
}

}  // namespace
}  // namespace mjdiag
