#include "mjdiag/studies/hidden_study.h"

#include <gtest/gtest.h>

#include "support/bonder.h"

namespace mjdiag {
namespace {

std::string NamesIn(const Discovery& discovery) {
  std::string names;
  for (const FoundCause& found : discovery.causes) {
    names += (names.empty() ? "" : ", ") + found.cause.name() + "@" + found.cause.site;
  }
  return names;
}

// Of the benchmark `mjdiag study --preset hidden` an offset, on shorter records and with fewer
// physics steps a tick; the benchmark has all kinds, and the walk of the Python package names
// dry friction of the bonder.
TEST(HiddenInTheBonder, IsFoundAndNamed) {
  constexpr int kOffset = 7;  // of the runs
  const Machine machine =
      test::Bonder({"trajectories.multi.duration=0.26"}).WithSubsteps(2);
  const HiddenOutcome outcome =
      RunHidden(machine, {.causes = 1, .exact = true}, kOffset + 1);
  EXPECT_EQ(outcome.truth.at(0).name(), "force_offset");
  EXPECT_TRUE(outcome.IsRight()) << "hidden: " << CauseWithValues(outcome.truth[0])
                                 << ", found: " << NamesIn(outcome.answer);
  EXPECT_LT(outcome.after_worst, 1.2);
}

}  // namespace
}  // namespace mjdiag
