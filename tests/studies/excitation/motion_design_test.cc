#include "mjdiag/studies/excitation/motion_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

  const Machine bonder_ = test::Bonder({"trajectories.multi.duration=0.5"});
};

// In a fifth of the time of the default motion, of which its ramps are a part; in all of it
// more than four times.
TEST_F(ExcitedBonder, TellsItsGuideTwiceAsWellAsTheDefaultMotion) {
  EXPECT_GT(Design().Gain(), 2.0);
}

// By another way, that of the study of the bounds.
TEST_F(ExcitedBonder, SaysTheBoundOfItsMotions) {
  const Eigen::VectorXd healthy = Eigen::VectorXd::Zero(8);
  const auto& setup = bonder_.setup();
  const Eigen::VectorXd before = FaultBoundAt(bonder_, DefaultMotion(setup), healthy);
  const Eigen::VectorXd after =
      FaultBoundAt(bonder_, FollowTrajectory(setup, Design().trajectory), healthy);
  for (Eigen::Index i = 0; i < Design().before.size(); ++i) {
    EXPECT_NEAR(Design().before[i] / before[i], 1.0, 1e-3) << i;
    EXPECT_NEAR(Design().after[i] / after[i], 1.0, 1e-3) << i;
  }
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
