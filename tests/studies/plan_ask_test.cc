#include "mjdiag/studies/plan/plan_ask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/dataset/run_work.h"
#include "mjdiag/studies/plan/planned_run.h"
#include "mjdiag/studies/preset/preset_plan.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kAskingHead = R"(schema = "mjdiag.plan/1"
name = "asking"
setup = ".."
linear = true
trajectories = ["xy"]
)";
constexpr const char* kTwoAxes = R"(method = "one at a time"
[[axis]]
fault = "zeta_x"
values = [1.1, 1.2]
[[axis]]
fault = "gamma"
values = [0.5]
)";

LoadedPlan Asking(const std::string& body, const std::string& ask) {
  return ParsePlanFor(test::Bonder(), kAskingHead + body + "[ask]\n" + ask, "plan");
}

std::string ComplaintOf(const std::string& body, const std::string& ask) {
  return test::MessageOf<InputError>([&] { Asking(body, ask); });
}

TEST(PlanAsk, IsOneOfTheQuestionsWithItsOwnKeys) {
  EXPECT_THAT(ComplaintOf("", "question = \"why\"\n"),
              AllOf(HasSubstr("plan:7: ask.question: is 'why'"),
                    HasSubstr("information bound"), HasSubstr("hidden causes")));
  EXPECT_THAT(ComplaintOf("", "question = \"estimates\"\nseeds = 3\n"),
              HasSubstr("ask.seeds: unknown key"));
  EXPECT_THAT(ComplaintOf("", "question = \"smallest size\"\njudges = [\"nobody\"]\n"),
              AllOf(HasSubstr("nobody"), HasSubstr("twin")));
  EXPECT_THAT(ComplaintOf("", "question = \"hidden causes\"\nexact = true\n"),
              HasSubstr("causes"));
  EXPECT_THAT(ComplaintOf("[keep]\nrecords = [\"x\"]\n", "question = \"estimates\"\n"),
              HasSubstr("keep: unknown key"));
}

TEST(PlanAsk, LeavesKeysOfASetupToThePlanThatNamesIt) {
  EXPECT_THAT(ComplaintOf("[[axis]]\nkey = \"sensors.x.noise_power\"\nvalues = [0]\n",
                          "question = \"estimates\"\n"),
              HasSubstr("varies sensors.x.noise_power"));
}

TEST(PlanAsk, GivesTheSameReplicationTheSameNoise) {
  LoadedPlan loaded = Asking(kTwoAxes, "question = \"estimates\"\n");
  loaded.plan.seed = 7;
  loaded.plan.SetRuns(2);
  const RunPlanner planner(loaded.plan);
  ASSERT_EQ(planner.runs(), 6);
  for (std::int64_t i = 0; i < planner.runs(); ++i) {
    EXPECT_EQ(planner.Run(i).seed, 7u + static_cast<std::uint64_t>(i % 2)) << i;
  }
}

TEST(PlanAsk, GivesPointsThatAreDrawnNoiseOfTheirOwn) {
  LoadedPlan loaded = Asking(
      "method = \"random\"\npoints = 3\n[[axis]]\nfault = \"zeta_x\"\n"
      "from = 1.1\nto = 2\n",
      "question = \"names\"\n");
  loaded.plan.SetRuns(5);
  const RunPlanner planner(loaded.plan);
  std::set<std::uint64_t> seeds;
  for (std::int64_t i = 0; i < planner.runs(); ++i) seeds.insert(planner.Run(i).seed);
  EXPECT_EQ(seeds, (std::set<std::uint64_t>{1, 2, 3, 4, 5}));
}

TEST(PlanAsk, IsNotWhatADataSetIsMadeOf) {
  const LoadedPlan asking = Asking("", "question = \"information bound\"\n");
  EXPECT_THROW(RunWork{asking}, InputError);
  LoadedPlan silent = asking;
  silent.plan.ask.reset();
  EXPECT_THROW(AnswerTo(silent, {}), InputError);
}

TEST(PlanAsk, IsRefusedOfCasesThatItCannotBeAskedOf) {
  const auto answered = [](const std::string& body, const std::string& ask) {
    return test::MessageOf<InputError>([&] { AnswerTo(Asking(body, ask), {}); });
  };
  EXPECT_THAT(answered(kTwoAxes, "question = \"names\"\n"), HasSubstr("with ranges"));
  EXPECT_THAT(answered("", "question = \"classes\"\n"), HasSubstr("with ranges"));
  EXPECT_THAT(answered("", "question = \"smallest size\"\n"),
              HasSubstr("lacks the case 'largest'"));
}

TEST(PlanAsk, IsWrittenAsTheDocumentationDoes) {
  const std::string page = ReadTextFile(MJDIAG_SOURCE_DIR "/docs/datasets.md");
  const std::string fence = "```toml ask\n";
  const std::size_t begin = page.find(fence) + fence.size();
  const LoadedPlan loaded =
      ParsePlan(page.substr(begin, page.find("```", begin) - begin), MJDIAG_SOURCE_DIR);
  EXPECT_TRUE(std::holds_alternative<AskSmallestSize>(loaded.plan.ask.value()));
}

TEST(PlanMethod, OneAtATimeLeavesTheOtherAxesHealthy) {
  const LoadedPlan loaded = Asking(kTwoAxes, "question = \"tolerance\"\n");
  const RunPlanner planner(loaded.plan);
  ASSERT_EQ(planner.runs(), 3);
  EXPECT_EQ(planner.Run(0).Label(), "zeta_x");
  EXPECT_EQ(planner.Run(0).axes[0].value, 1.1);
  EXPECT_EQ(planner.Run(1).axes[0].value, 1.2);
  EXPECT_EQ(planner.Run(1).axes[1].value, 0.0);
  EXPECT_EQ(planner.Run(2).Label(), "gamma");
  EXPECT_EQ(planner.Run(2).axes[0].value, 1.0);
}

TEST(Presets, ArePlansThatAskSomething) {
  const Machine bonder = test::Bonder();
  EXPECT_EQ(PresetNames().size(), 16u);
  for (const std::string& name : PresetNames()) {
    EXPECT_TRUE(ReadPreset(name, bonder).plan.ask) << name;
  }
}

TEST(Presets, OfAMachineComeBeforeThoseThatShip) {
  const test::TemporaryFolder folder;
  std::filesystem::copy(MJDIAG_SOURCE_DIR "/mjcf/emps", folder.path() / "stage",
                        std::filesystem::copy_options::recursive);
  const auto bound = [&] {
    const Machine stage(ReadSetup(folder.path() / "stage", {}));
    return ReadPreset("bound", stage).plan.name;
  };
  EXPECT_EQ(bound(), "bound");
  std::filesystem::create_directories(folder.path() / "stage/plans");
  WriteTextFile(folder.path() / "stage/plans/bound.toml",
                "schema = \"mjdiag.plan/1\"\nname = \"mine\"\nsetup = \"..\"\n"
                "linear = true\n[ask]\nquestion = \"information bound\"\n");
  EXPECT_EQ(bound(), "mine");
  EXPECT_THAT(test::MessageOf<InputError>([] { ReadPreset("table9", test::Bonder()); }),
              HasSubstr("table2"));
}

}  // namespace
}  // namespace mjdiag
