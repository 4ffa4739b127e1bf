#include "mjdiag/discovery/selection/moves.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// What a search would hand over if it had found these causes.
struct Found {
  test::StageUnderTest stage;
  DiscoveryProblem problem;
  std::vector<Candidate> candidates;
  SearchData data;
  HypothesisSet set;

  Found(const std::vector<std::string>& hidden,
        const std::vector<std::pair<std::string, VectorXd>>& found)
      : problem(stage.Pose(stage.Measure(hidden))),
        candidates(ListCandidates(stage.machine)),
        data{problem, Beginning(problem, problem.train() / 4), candidates,
             DataOf(problem, candidates, nullptr)} {
    std::vector<FittedCause> causes;
    for (const auto& [name, value] : found) {
      causes.push_back({test::Place(candidates, name), value});
      set.rivals.push_back({{causes.back(), 0.0, 1.0}});
    }
    Judge(causes);
  }
  /// Another record, which speaks against sets that begin with this cause.
  void SpeakAgainst(const std::string& name) {
    data.evidence.replay =
        [place = test::Place(candidates, name)](const FittedModel& model) -> VectorXd {
      return VectorXd::Constant(1000, model.causes[0].candidate == place ? 100.0 : 0.0);
    };
    Judge(set.fit().causes);
  }
  /// Another record, which speaks against sets of one cause.
  void SpeakAgainstOne() {
    data.evidence.replay = [](const FittedModel& model) -> VectorXd {
      return VectorXd::Constant(1000, model.causes.size() == 1 ? 100.0 : 0.0);
    };
    Judge(set.fit().causes);
  }
  std::string Name(std::size_t i) const {
    return Describe(candidates[set.fit().causes[i].candidate]);
  }

 private:
  void Judge(const std::vector<FittedCause>& causes) {
    set.evidence = {data.evidence, FitCauses(problem, candidates, {causes}, {}),
                    VectorXd::Ones(1)};
  }
};

TEST(Exchange, PutsTheSimplerLawInThePlaceOfOneThatExplainsNoMore) {
  Found found({"added_mass@load:mass=0.05"},
              {{"flexible_mode@load", Eigen::Vector3d(0.05, 400.0, 0.1)}});
  ASSERT_TRUE(Exchange(found.data, found.set));
  ASSERT_EQ(found.set.fit().causes.size(), 1u);
  EXPECT_EQ(found.Name(0), "added_mass@load");
  EXPECT_NEAR(found.set.fit().causes[0].value[0], 0.05, 0.005);
  EXPECT_EQ(found.set.rivals[0].front().cause.candidate,
            test::Place(found.candidates, "added_mass@load"));
  EXPECT_FALSE(Exchange(found.data, found.set));
}

TEST(Exchange, DoesNotPutInThePlaceOfACauseWhatUnseenDataSpeakAgainst) {
  Found found({"added_mass@load:mass=0.05"},
              {{"flexible_mode@load", Eigen::Vector3d(0.05, 400.0, 0.1)}});
  found.SpeakAgainst("added_mass@load");
  EXPECT_FALSE(Exchange(found.data, found.set));
  EXPECT_EQ(found.Name(0), "flexible_mode@load");
}

TEST(Exchange, DoesNotPutInThePlaceOfACauseWhatUnseenDataAloneSpeakFor) {
  Found found({"added_mass@load:mass=0.05"},
              {{"added_mass@load", VectorXd::Constant(1, 0.05)}});
  found.SpeakAgainst("added_mass@load");
  EXPECT_FALSE(Exchange(found.data, found.set));
  EXPECT_EQ(found.Name(0), "added_mass@load");
}

TEST(Exchange, PutsTheRightLawInThePlaceOfAnotherKind) {
  Found found({"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"},
              {{"asymmetric_viscous_friction@load", Eigen::Vector2d(1.0, 1.0)},
               {"force_offset@load", VectorXd::Constant(1, 0.05)}});
  ASSERT_TRUE(Exchange(found.data, found.set));
  EXPECT_EQ(found.Name(0), "force_offset@load");
  EXPECT_EQ(found.Name(1), "quadratic_drag@load");
  EXPECT_NEAR(found.set.fit().causes[1].value[0], 20.0, 0.2);
}

TEST(Moves, LeaveWhatIsRight) {
  Found found({"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"},
              {{"quadratic_drag@load", VectorXd::Constant(1, 20.0)},
               {"force_offset@load", VectorXd::Constant(1, 0.05)}});
  EXPECT_FALSE(Exchange(found.data, found.set));
  EXPECT_FALSE(Drop(found.data, found.set));
  EXPECT_EQ(found.set.fit().causes.size(), 2u);
}

// No mode of a machine is damped like that: friction is.
TEST(GiveUpIncredible, TakesOutALawAtItsEndWhateverItExplains) {
  Found found({"quadratic_drag@load:coefficient=20",
               "flexible_mode@load:mass=0.1,frequency=20,damping_ratio=0.8"},
              {{"flexible_mode@load", Eigen::Vector3d(0.1, 20.0, 0.3)},
               {"quadratic_drag@load", VectorXd::Constant(1, 20.0)}});
  const double before = found.set.evidence.Criterion();
  ASSERT_TRUE(GiveUpIncredible(found.data, found.set));
  EXPECT_EQ(found.Name(0), "quadratic_drag@load");
  EXPECT_EQ(found.set.rivals.size(), found.set.fit().causes.size());
  EXPECT_GT(found.set.evidence.Criterion(), before);
  EXPECT_FALSE(GiveUpIncredible(found.data, found.set));
}

TEST(Drop, TakesOutWhatIsSuperfluous) {
  Found found({"quadratic_drag@load:coefficient=20"},
              {{"quadratic_drag@load", VectorXd::Constant(1, 20.0)},
               {"force_offset@load", VectorXd::Constant(1, 0.01)}});
  ASSERT_TRUE(Drop(found.data, found.set));
  ASSERT_EQ(found.set.fit().causes.size(), 1u);
  EXPECT_EQ(found.Name(0), "quadratic_drag@load");
  EXPECT_EQ(found.set.rivals.size(), 1u);
}

TEST(Drop, LeavesWhatUnseenDataNeed) {
  Found found({"quadratic_drag@load:coefficient=20"},
              {{"quadratic_drag@load", VectorXd::Constant(1, 20.0)},
               {"force_offset@load", VectorXd::Constant(1, 0.01)}});
  found.SpeakAgainstOne();
  EXPECT_FALSE(Drop(found.data, found.set));
}

// The small part of a law that the other explains for itself.
TEST(Better, PutsTheLargerLawInThePlaceOfTheOneThatItContains) {
  Found found({"stribeck_friction@load:coulomb=3,breakaway=1,velocity=0.02"},
              {{"coulomb_friction@load", VectorXd::Constant(1, 3.0)}});
  ASSERT_TRUE(Better(found.data, found.set, {}));
  ASSERT_EQ(found.set.fit().causes.size(), 1u);
  EXPECT_EQ(found.Name(0), "stribeck_friction@load");
  EXPECT_NEAR(found.set.fit().causes[0].value[1], 1.0, 0.1);
  ASSERT_EQ(found.set.rivals.size(), 1u);
}

TEST(Better, LeavesACauseThatNothingExplainsBetterThan) {
  Found found({"coulomb_friction@load:force=3"},
              {{"coulomb_friction@load", VectorXd::Constant(1, 3.0)}});
  EXPECT_FALSE(Better(found.data, found.set, {}));
  EXPECT_EQ(found.Name(0), "coulomb_friction@load");
}

TEST(Merge, PutsALawInThePlaceOfItsParts) {
  Found found(
      {"gear_load_friction@load:motor_share=0.05,load_share=0.03,quadratic=1e-3"},
      {{"directional_load_friction@load", Eigen::Vector2d(0.05, 0.03)},
       {"quadratic_load_friction@load", VectorXd::Constant(1, 1e-3)}});
  ASSERT_TRUE(Merge(found.data, found.set));
  ASSERT_EQ(found.set.fit().causes.size(), 1u);
  EXPECT_EQ(found.Name(0), "gear_load_friction@load");
  EXPECT_NEAR(found.set.fit().causes[0].value[2], 1e-3, 1e-4);
  ASSERT_EQ(found.set.rivals.size(), 1u);
  EXPECT_EQ(found.set.rivals[0].front().cause.candidate,
            test::Place(found.candidates, "gear_load_friction@load"));
}

TEST(Merge, LeavesTwoThatAreTwo) {
  Found found({"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"},
              {{"quadratic_drag@load", VectorXd::Constant(1, 20.0)},
               {"force_offset@load", VectorXd::Constant(1, 0.05)}});
  EXPECT_FALSE(Merge(found.data, found.set));
  EXPECT_EQ(found.set.fit().causes.size(), 2u);
}

}  // namespace
}  // namespace mjdiag
