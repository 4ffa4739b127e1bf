#include "mjdiag/studies/hidden_study.h"

#include <gtest/gtest.h>

#include "support/bonder.h"

namespace mjdiag {
namespace {

std::string Named(const Discovery& discovery) {
  std::string names;
  for (const FoundCause& found : discovery.causes) {
    names += (names.empty() ? "" : ", ") + found.cause.name() + "@" + found.cause.site;
  }
  return names;
}

// Of the benchmark `mjdiag study --preset hidden` dry friction and an offset, on shorter
// records and with fewer physics steps a tick; the benchmark has all kinds.
class HiddenInTheBonder : public ::testing::TestWithParam<int> {};

TEST_P(HiddenInTheBonder, IsFoundAndNamed) {
  const Machine machine =
      test::Bonder({"trajectories.multi.duration=0.5"}).WithSubsteps(2);
  const int run = GetParam();
  const HiddenOutcome outcome =
      RunHidden(machine, TypesOfRun(run, 1), static_cast<std::uint64_t>(run) + 1);
  EXPECT_TRUE(outcome.right) << "hidden: " << CauseWithValues(outcome.hidden.truth[0])
                             << ", found: " << Named(outcome.answer);
  EXPECT_LT(outcome.unseen_ratio, 1.2);
}

INSTANTIATE_TEST_SUITE_P(AHandful, HiddenInTheBonder, ::testing::Values(0, 7));

}  // namespace
}  // namespace mjdiag
