#include "mjdiag/studies/excitation/motion_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/bound_study.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ExcitedBonder : public ::testing::Test {
 protected:
  static MotionDesignOptions BetaX() {
    MotionDesignOptions options;
    options.wanted = {"beta_x"};
    return options;
  }
  /// Once for all tests.
  const MotionDesign& Design() const {
    static const MotionDesign design = DesignMotion(bonder_, BetaX());
    return design;
  }

  const Machine bonder_ = test::Bonder();
};

TEST_F(ExcitedBonder, TellsItsGuideTwiceAsWellAsTheDefaultMotion) {
  EXPECT_GT(Design().Gain(), 2.0);
}

// By another way, that of the study of the bounds, which sees every tick: means over a
// block of a millisecond lose little of moves.
TEST_F(ExcitedBonder, SaysTheBoundOfTheDefaultMotion) {
  const Eigen::VectorXd before =
      FaultBoundAt(bonder_, DefaultMotion(bonder_.setup()), Eigen::VectorXd::Zero(8));
  for (Eigen::Index i = 0; i < Design().before.size(); ++i) {
    EXPECT_GT(Design().before[i] / before[i], 0.99) << i;
    EXPECT_LT(Design().before[i] / before[i], 1.10) << i;
  }
}

// The standard deviation that the twin of the machine claims is the one that was promised:
// where its noise is as large as it says.
TEST_F(ExcitedBonder, ItsTwinKeepsThePromise) {
  const auto motion = FollowTrajectory(bonder_.setup(), Design().trajectory);
  const Record record = SimulateLinear(bonder_, motion, {});
  const auto twin = MakeTwinEstimator(bonder_, true);
  const Eigen::MatrixXd y = SamplesOf(record, bonder_.linear().outputs);
  const Eigen::MatrixXd u = SamplesOf(record, bonder_.linear().inputs);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    twin->Add({y.col(k).data(), 3}, {u.col(k).data(), 3});
  }
  twin->CatchUp();
  EXPECT_NEAR(twin->Read().sd[2] / Design().after[2], 1.0, 0.15);
}

TEST_F(ExcitedBonder, KeepsEveryLimitInTheNonlinearMachine) {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Excitation motion = FollowTrajectory(bonder_.setup(), Design().trajectory);
  const std::vector<AxisCourse> courses =
      CoursesOf(bonder_, motion, Simulate(bonder_, motion, quiet));
  for (std::size_t axis = 0; axis < courses.size(); ++axis) {
    const AxisLimits peaks = PeaksOf(courses[axis], bonder_.rates().tick());
    EXPECT_LE(Utilisation(peaks, Design().limits[axis]), 1.0 + 1e-6) << axis;
    EXPECT_EQ(peaks.force, Design().peaks[axis].force);
  }
}

TEST_F(ExcitedBonder, KeepsToALimitThatIsGiven) {
  MotionDesignOptions options = BetaX();
  options.limits["x"].force = 20.0;
  options.stop = [] { return true; };  // its moves, smaller
  const MotionDesign design = DesignMotion(bonder_, options);
  EXPECT_EQ(design.limits[0].force, 20.0);
  EXPECT_LE(design.peaks[0].force, 20.0 * (1.0 + 1e-6));
  EXPECT_LT(design.limits[0].velocity, AxisLimits::kNone);
}

TEST_F(ExcitedBonder, EndsWithWhatItHasWhenAsked) {
  MotionDesignOptions options = BetaX();
  options.stop = [] { return true; };
  const MotionDesign design = DesignMotion(bonder_, options);
  EXPECT_TRUE(design.stopped);
  EXPECT_FALSE(design.trajectory.moves.empty());
}

// Of axes that the default motion leaves alone no share of a move is within the limits.
TEST_F(ExcitedBonder, LeavesOutMovesOfAxesThatHaveToRest) {
  for (const std::string name : {"x", "xy"}) {
    const Machine resting = test::Bonder({"default_trajectory=\"" + name + "\"",
                                          "trajectories." + name + ".duration=0.26"});
    MotionDesignOptions options = BetaX();
    options.stop = [] { return true; };
    const MotionDesign design = DesignMotion(resting, options);
    EXPECT_GT(design.peaks[0].velocity, 0.0) << name;
    EXPECT_EQ(design.peaks[2].velocity, 0.0) << name;
  }
}

TEST_F(ExcitedBonder, RefusesWhatItDoesNotKnow) {
  const auto refuses = [&](const MotionDesignOptions& options, const char* words) {
    EXPECT_THAT([&] { DesignMotion(bonder_, options); },
                ThrowsMessage<InputError>(HasSubstr(words)));
  };
  MotionDesignOptions options;
  options.wanted = {"beta_w"};
  refuses(options, "no fault parameter 'beta_w'");
  options.wanted = {"mass@nothing"};
  refuses(options, "nothing");
  options = {};
  options.limits["w"].force = 1.0;
  refuses(options, "no axis 'w'");
  options = {};
  options.limits["x"].force = 0.0;
  refuses(options, "force is not above 0");
}

}  // namespace
}  // namespace mjdiag
