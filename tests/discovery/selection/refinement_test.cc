#include "mjdiag/discovery/selection/refinement.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

/// What a search would hand over if it had found these causes.
struct Found {
  test::StageUnderTest stage;
  DiscoveryProblem problem;
  DiscoveryProblem beginning;
  std::vector<Candidate> candidates;
  Eigen::VectorXd independent = Eigen::VectorXd::Ones(1);
  CauseSet set;

  Found(const std::vector<std::string>& hidden,
        const std::vector<std::pair<std::string, Eigen::VectorXd>>& found)
      : problem(stage.Pose(stage.Measure(hidden))),
        beginning(Beginning(problem, problem.train / 4)),
        candidates(ListCandidates(stage.machine)) {
    std::vector<FittedCause> causes;
    for (const auto& [name, value] : found) {
      causes.push_back({test::Place(candidates, name), value});
      set.contenders.push_back({{causes.back(), 0.0, 1.0}});
    }
    set.fit = FitCauses(problem, candidates, causes, {});
  }
  using Deviance = std::function<double(const CauseFit&)>;
  Refinement Refine(Deviance unseen = [](const CauseFit&) { return 0.0; }) const {
    return {problem, beginning, candidates, independent, std::move(unseen)};
  }
  /// Unseen data that speak against this as the first cause.
  Deviance Against(const std::string& name) const {
    return [place = test::Place(candidates, name)](const CauseFit& fit) {
      return fit.causes[0].candidate == place ? 1e4 : 0.0;
    };
  }
  std::string Name(std::size_t i) const {
    return Describe(candidates[set.fit.causes[i].candidate]);
  }
};

TEST(Refinement, PutsTheSimplerLawInThePlaceOfOneThatExplainsNoMore) {
  Found found({"added_mass@load:mass=0.05"},
              {{"flexible_mode@load", Eigen::Vector3d(0.05, 400.0, 0.1)}});
  ASSERT_TRUE(found.Refine().Exchange(found.set));
  ASSERT_EQ(found.set.fit.causes.size(), 1u);
  EXPECT_EQ(found.Name(0), "added_mass@load");
  EXPECT_NEAR(found.set.fit.causes[0].value[0], 0.05, 0.005);
  EXPECT_EQ(found.set.contenders[0].front().cause.candidate,
            test::Place(found.candidates, "added_mass@load"));
  EXPECT_FALSE(found.Refine().Exchange(found.set));
}

TEST(Refinement, DoesNotPutInThePlaceOfACauseWhatUnseenDataSpeakAgainst) {
  Found found({"added_mass@load:mass=0.05"},
              {{"flexible_mode@load", Eigen::Vector3d(0.05, 400.0, 0.1)}});
  EXPECT_FALSE(found.Refine(found.Against("added_mass@load")).Exchange(found.set));
  EXPECT_EQ(found.Name(0), "flexible_mode@load");
}

TEST(Refinement, DoesNotPutInThePlaceOfACauseWhatUnseenDataAloneSpeakFor) {
  Found found({"added_mass@load:mass=0.05"},
              {{"added_mass@load", Eigen::VectorXd::Constant(1, 0.05)}});
  EXPECT_FALSE(found.Refine(found.Against("added_mass@load")).Exchange(found.set));
  EXPECT_EQ(found.Name(0), "added_mass@load");
}

TEST(Refinement, PutsTheRightLawInThePlaceOfAnotherKind) {
  Found found({"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"},
              {{"asymmetric_viscous_friction@load", Eigen::Vector2d(1.0, 1.0)},
               {"force_offset@load", Eigen::VectorXd::Constant(1, 0.05)}});
  ASSERT_TRUE(found.Refine().Exchange(found.set));
  EXPECT_EQ(found.Name(0), "force_offset@load");
  EXPECT_EQ(found.Name(1), "quadratic_drag@load");
  EXPECT_NEAR(found.set.fit.causes[1].value[0], 20.0, 0.2);
}

TEST(Refinement, LeavesWhatIsRight) {
  Found found({"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"},
              {{"quadratic_drag@load", Eigen::VectorXd::Constant(1, 20.0)},
               {"force_offset@load", Eigen::VectorXd::Constant(1, 0.05)}});
  EXPECT_FALSE(found.Refine().Exchange(found.set));
  EXPECT_FALSE(found.Refine().Prune(found.set));
  EXPECT_EQ(found.set.fit.causes.size(), 2u);
}

TEST(Refinement, DropsWhatIsSuperfluous) {
  Found found({"quadratic_drag@load:coefficient=20"},
              {{"quadratic_drag@load", Eigen::VectorXd::Constant(1, 20.0)},
               {"force_offset@load", Eigen::VectorXd::Constant(1, 0.01)}});
  ASSERT_TRUE(found.Refine().Prune(found.set));
  ASSERT_EQ(found.set.fit.causes.size(), 1u);
  EXPECT_EQ(found.Name(0), "quadratic_drag@load");
}

}  // namespace
}  // namespace mjdiag
