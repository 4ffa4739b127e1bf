#include "mjdiag/studies/hidden_study.h"

#include <gtest/gtest.h>

#include "support/bonder.h"

namespace mjdiag {
namespace {

std::string Named(const Discovery& discovery) {
  std::string names;
  for (const FoundCause& found : discovery.causes) {
    names += (names.empty() ? "" : ", ") + found.cause.name() + "@" +
             found.cause.site;
  }
  return names;
}

// A fixed handful of the benchmark `mjdiag study --preset hidden`, on shorter records:
// dry friction, an offset, a spring, an encoder's scale.
class HiddenInTheBonder : public ::testing::TestWithParam<int> {};

TEST_P(HiddenInTheBonder, IsFoundAndNamed) {
  const Machine machine = test::Bonder({"trajectories.multi.duration=0.75"});
  const int run = GetParam();
  const HiddenOutcome outcome =
      RunHidden(machine, TypesOfRun(run, 1), static_cast<std::uint64_t>(run + 1));
  EXPECT_TRUE(outcome.right) << "hidden: " << Describe(outcome.hidden.truth[0])
                             << ", found: " << Named(outcome.answer);
  EXPECT_LT(outcome.unseen_ratio, 1.2);
}

INSTANTIATE_TEST_SUITE_P(AHandful, HiddenInTheBonder, ::testing::Values(0, 7, 15, 22));

}  // namespace
}  // namespace mjdiag
