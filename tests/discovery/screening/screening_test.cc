#include "mjdiag/discovery/screening/screening.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/screening/screener.h"
#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A measurement and all candidates of the stage.
struct Screened {
  test::StageUnderTest stage;
  DiscoveryProblem problem;
  std::vector<Candidate> candidates = ListCandidates(stage.machine);

  explicit Screened(const std::vector<std::string>& effects, std::uint64_t seed = 1)
      : problem(stage.Pose(stage.Measure(effects, {}, seed))) {}

  /// Beside the causes, which have these sensitivities.
  Screening Beside(const std::vector<FittedCause>& causes = {},
                   const MatrixXd& sensitivities = {}) const {
    return ScreenBeside(problem, candidates, {causes}, sensitivities, 1);
  }
  const Start& StartOf(const Screening& screening, const std::string& name) const {
    const std::size_t place = test::Place(candidates, name);
    return *std::ranges::find(screening.starts, place,
                              [](const Start& start) { return start.cause.candidate; });
  }
  /// Squared innovations of the part that fits see, with those causes.
  double Left(const std::vector<FittedCause>& causes) const {
    const VectorXd residual = problem.Residual(ChangesOf(candidates, causes));
    return residual.segment(problem.skip(), problem.train() - problem.skip())
        .squaredNorm();
  }
};

struct SmallEffect {
  std::string name;
  std::string spec;
};

// Small beside the friction and the mass that the plant has, a hundred times noise.
const std::vector<SmallEffect>& SmallEffects() {
  static const std::vector<SmallEffect> effects{
      {"quadratic_drag@load", "quadratic_drag@load:coefficient=20"},
      {"added_mass@load", "added_mass@load:mass=0.02"},
      {"force_ripple@load", "force_ripple@load:amplitude=0.05,period=0.024,phase=0.3"},
      {"encoder_periodic_error@load_encoder",
       "encoder_periodic_error@load_encoder:amplitude=2e-8,period=0.004,phase=1"}};
  return effects;
}

TEST(Screening, PromisesOfASmallEffectWhatItTakesAwayOfTheSquaredInnovations) {
  constexpr double kFirstOrder = 0.1;  // how far off a promise may be, relative
  for (const auto& [name, effect] : SmallEffects()) {
    SCOPED_TRACE(name);
    const Screened screened({effect});
    const Screening screening = screened.Beside();
    const Start& start = screened.StartOf(screening, name);
    const double drop =
        screened.Left({}) - screened.Left({Bounded(screened.candidates, start.cause)});
    EXPECT_GT(drop, 500.0) << "hardly shows";
    EXPECT_NEAR(start.gain, drop, kFirstOrder * drop);
    // Nothing else explains it better by more than noise makes of it.
    EXPECT_LT(screening.starts.front().gain, 1.05 * start.gain);
  }
}

TEST(Screening, StartsAFitNearTheTruth) {
  const Screened screened({"quadratic_drag@load:coefficient=20"});
  const Screening screening = screened.Beside();
  EXPECT_NEAR(screened.StartOf(screening, "quadratic_drag@load").cause.value[0], 20.0,
              0.5);
}

TEST(Screening, OfNoiseAloneFindsNothingSignificant) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Screened screened({}, seed);
    const Screening screening = screened.Beside();
    EXPECT_GT(screening.trials, 100);
    for (const Start& start : screening.starts) {
      EXPECT_LT(start.gain, GainByChance(1e-3, screening.trials, start.freedom))
          << Describe(screened.candidates[start.cause.candidate]);
    }
  }
}

// Of what a cause that has been found explains already nothing is gained again, by it
// or by what looks the same; another one still shows.
TEST(Screening, LooksPastWhatHasBeenFound) {
  const Screened screened(
      {"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"});
  const std::size_t drag = test::Place(screened.candidates, "quadratic_drag@load");
  const auto with = [&](double coefficient) {
    return std::vector<FittedCause>{{drag, VectorXd::Constant(1, coefficient)}};
  };
  const auto residual = [&](double coefficient) {
    return screened.problem.Residual(ChangesOf(screened.candidates, with(coefficient)));
  };
  const MatrixXd slope = residual(20.5) - residual(19.5);
  const Screening blind = screened.Beside();
  const Screening past = screened.Beside(with(20.0), slope);
  const double gain = screened.StartOf(blind, "quadratic_drag@load").gain;
  for (const Start& start : past.starts) {
    if (start.cause.candidate != drag) continue;
    // What is left of its direction can take something of the other one.
    EXPECT_LT(start.gain, 1e-2 * gain);
  }
  EXPECT_GT(screened.StartOf(past, "force_offset@load").gain, 500.0);
  EXPECT_LT(past.rest, blind.rest - 0.5 * gain);
}

/// The Screener of a problem that is all for the fit.
struct Bench {
  DiscoveryProblem problem;
  std::shared_ptr<const LinearisedRun> run = problem.Linearised({});
  VectorXd residual = problem.Scaled(run->track);
};

TEST(Screener, HasARestThatIsOrthogonalToWhatHasBeenFound) {
  const Screened screened({"quadratic_drag@load:coefficient=20"});
  const Bench bench{screened.problem.TrainPart()};
  const Screener all(bench.problem, bench.run->dynamics, bench.residual, {}, {});
  // Of one channel; what still settles does not count.
  const VectorXd counted =
      bench.residual.tail(bench.residual.size() - bench.problem.skip());
  EXPECT_NEAR(all.Rest(), counted.squaredNorm(), 1e-9 * counted.squaredNorm());
  // What has been found spans the residual itself: nothing is left. Half of it and
  // something else: what is orthogonal to both.
  MatrixXd found(bench.residual.size(), 1);
  found.col(0) = 3.0 * bench.residual;
  const Screener none(bench.problem, bench.run->dynamics, bench.residual, found, {});
  EXPECT_LT(none.Rest(), 1e-9 * all.Rest());
  found.col(0) = VectorXd::Ones(found.rows());
  const Screener mean(bench.problem, bench.run->dynamics, bench.residual, found, {});
  const double sum = counted.sum();
  EXPECT_NEAR(mean.Rest(), all.Rest() - sum * sum / static_cast<double>(counted.size()),
              1e-9 * all.Rest());
}

// Over five periods of a ripple that is far above noise.
TEST(BetterWaves, FindThePeriodThatAWrongOneMisses) {
  const Screened screened({"force_ripple@load:amplitude=0.5,period=0.024,phase=0.3"});
  const Bench bench{Beginning(screened.problem, 3000)};
  const ObservedMotion motion = bench.problem.MotionOf(bench.run->track);
  const Candidate& ripple =
      screened.candidates[test::Place(screened.candidates, "force_ripple@load")];
  const auto better = [&](double present) {
    return BetterWaves(bench.problem, ripple, present, motion, bench.run->dynamics,
                       bench.residual, {}, {}, 3);
  };
  const std::vector<Start> starts = better(0.015);
  ASSERT_FALSE(starts.empty());
  EXPECT_LE(starts.size(), 3u);
  EXPECT_NEAR(starts[0].cause.value[PeriodPlace(ripple)], 0.024, 0.024 * 2e-3);
  for (const Start& start : better(0.024)) {
    EXPECT_NEAR(start.cause.value[PeriodPlace(ripple)], 0.024, 0.024 * 0.01);
  }
}

}  // namespace
}  // namespace mjdiag
