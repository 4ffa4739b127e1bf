// A discovery that may not do all it would.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/effect.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// Friction and a ripple, of which a search finds one after the other.
class Budget : public ::testing::Test {
 protected:
  static DiscoverOptions Within(double seconds) {
    DiscoverOptions options;
    options.figures = false;
    options.budget = seconds;
    // Few, for these tests are about how a search ends.
    options.choice.only = {"coulomb_friction", "force_ripple", "force_offset", "eta"};
    return options;
  }
  Discovery Answer(const DiscoverOptions& options) const {
    return Discover(stage_.machine, record_, nullptr, options);
  }
  /// Of a search that may do all it would: once for all tests, for it takes the longest.
  const Discovery& Free() const {
    static const Discovery free = Answer(Within(kUnlimited));
    return free;
  }
  static std::string Named(const Discovery& discovery) {
    std::string names;
    for (const FoundCause& found : discovery.causes) {
      names += (names.empty() ? "" : ", ") + FormatEffect(found.cause);
      for (const CauseParameter& p : found.parameters) {
        names += " " + std::to_string(p.low) + " " + std::to_string(p.high);
      }
    }
    return names;
  }

  const test::Stage stage_;
  const Record record_ =
      stage_.Measure({"coulomb_friction@load:force=18",
                      "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"});
};

TEST_F(Budget, ChangesNothingOfAnAnswerThatEndsWithinIt) {
  const Discovery& free = Free();
  ASSERT_EQ(free.causes.size(), 2u);
  EXPECT_TRUE(free.budget.left_out.empty());
  const Discovery bound = Answer(Within(20.0 * free.budget.used));
  EXPECT_EQ(Named(bound), Named(free));
  EXPECT_EQ(bound.notes, free.notes);
}

TEST_F(Budget, IsNeededForNoAnswerToBeTheSameWithAnyNumberOfThreads) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Discovery alone = Answer(Within(kUnlimited));
  EXPECT_EQ(Named(alone), Named(Free()));
  EXPECT_EQ(alone.notes, Free().notes);
}

// A budget is of the clock, which asserts nothing here: what it leaves out is said.
TEST_F(Budget, SaysWhatIsLeftOut) {
  const Discovery answer = Answer(Within(0.05 * Free().budget.used));
  EXPECT_FALSE(answer.budget.left_out.empty());
  EXPECT_THAT(answer.notes, Contains(HasSubstr("ended by its budget of")));
  EXPECT_THAT(answer.notes, Contains(HasSubstr("--budget")));
}

// Asked to end with the first cause in hand.
TEST_F(Budget, LeavesTheBestCauseSoFar) {
  DiscoverOptions options = Within(kUnlimited);
  std::atomic<bool> has_one = false;
  options.progress = [&](const DiscoveryProgress& progress) {
    if (!progress.best.empty()) has_one = true;
  };
  options.stop = [&] { return has_one.load(); };
  const Discovery answer = Answer(options);
  ASSERT_FALSE(answer.causes.empty());
  EXPECT_EQ(answer.causes[0].cause.name(), "coulomb_friction");
  for (const CauseParameter& parameter : answer.causes[0].parameters) {
    EXPECT_LT(parameter.low, parameter.high);
  }
}

// No more is claimed than was looked for.
TEST_F(Budget, TooSmallForAnySearchSaysNotThatThereIsNothing) {
  const Discovery answer = Answer(Within(1e-3));
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kUnexplained);
  EXPECT_TRUE(answer.causes.empty());
}

TEST_F(Budget, EndsSoonAfterItIsAskedTo) {
  std::atomic<int> asked = 0;
  DiscoverOptions options = Within(kUnlimited);
  options.stop = [&] { return ++asked > 40; };  // in the midst of the first fits
  const Discovery answer = Answer(options);
  EXPECT_TRUE(answer.budget.stopped);
  EXPECT_THAT(answer.notes, Contains(HasSubstr("it was stopped")));
  EXPECT_THAT(answer.budget.left_out, Contains("further causes"));
  EXPECT_LT(answer.budget.used, Free().budget.used);
}

TEST_F(Budget, NamesOnlyWhatWasChosen) {
  EXPECT_EQ(Free().causes.size(), 2u);
  DiscoverOptions options = Within(kUnlimited);
  options.choice.without = {"coulomb_friction"};
  EXPECT_THAT(Named(Answer(options)), Not(HasSubstr("coulomb_friction@")));
  const Record noisy = stage_.Measure({"encoder_noise@load_encoder:sd=1.5e-8"});
  options.choice = {{}, {"encoder_noise"}};
  EXPECT_TRUE(Discover(stage_.machine, noisy, nullptr, options).causes.empty());
}

TEST_F(Budget, ProgressTellsTheBestAnswerSoFar) {
  std::vector<std::string> best;
  DiscoverOptions options = Within(kUnlimited);
  options.progress = [&](const DiscoveryProgress& progress) {
    EXPECT_FALSE(progress.what.empty());
    best.push_back(progress.best);
  };
  Answer(options);
  EXPECT_EQ(best.front(), "");
  EXPECT_THAT(best,
              Contains(HasSubstr(
                  "coulomb_friction@load, force_ripple@load (mismatch 100 % to ")));
}

}  // namespace
}  // namespace mjdiag
