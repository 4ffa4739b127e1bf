#include "mjdiag/render/clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/clip_writer.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "render/test_machine.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

class Clip : public ::testing::Test {
 protected:
  Clip() {
    options_.picture.width = 640;
    options_.picture.height = 360;
    options_.picture.camera = "front";
    options_.picture.smoothing = Smoothing::kNone;
    options_.fps = 10.0;
    options_.speed = 0.1;  // 0.1 s of run: frames 0 .. 10
  }

  std::string Failure(const ClipOptions& options, const std::filesystem::path& file) {
    try {
      RenderClip(*model_, runs_, options, file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const ModelPtr model_ = test::Machine();
  const Record healthy_ = test::Run({});
  const Record faulty_ = test::Run({.mount = 4e-8, .stage = 3e-6});
  const std::vector<ClipRun> runs_{{"Healthy", &healthy_}, {"Faulty", &faulty_}};
  const test::TemporaryFolder folder_;
  ClipOptions options_;
};

TEST_F(Clip, CanBeReadBackFrameByFrame) {
  const auto file = folder_ / "clip.mp4";
  const ClipSummary summary = RenderClip(*model_, runs_, options_, file);
  EXPECT_EQ(summary.frames, 11);
  cv::VideoCapture video(file.string());
  ASSERT_TRUE(video.isOpened());
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_WIDTH), 640);
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_HEIGHT), 360);
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 10.0, 1e-6);
  int frames = 0;
  for (cv::Mat frame; video.read(frame);) ++frames;
  EXPECT_EQ(frames, 11);
  EXPECT_EQ(folder_.size(), 1);
}

TEST_F(Clip, GivesTheSameFramesEveryTime) {
  options_.frames = folder_ / "a";
  RenderClip(*model_, runs_, options_, folder_ / "a.mp4");
  options_.frames = folder_ / "b";
  RenderClip(*model_, runs_, options_, folder_ / "b.mp4");
  for (const char* name :
       {"frame_000000.png", "frame_000005.png", "frame_000010.png"}) {
    EXPECT_EQ(ReadTextFile(folder_ / "a" / name), ReadTextFile(folder_ / "b" / name));
  }
  EXPECT_NE(ReadTextFile(folder_ / "a" / "frame_000000.png"),
            ReadTextFile(folder_ / "a" / "frame_000005.png"));
}

TEST_F(Clip, GivesTheSameFramesEveryTimeWithGhostAndDiagnosis) {
  for (const bool ghost : {false, true}) {
    options_.picture.ghost = ghost;
    options_.picture.diagnosis = test::Overlay();
    const test::TemporaryFolder folder;
    for (const char* name : {"a", "b"}) {
      options_.frames = folder / name;
      RenderClip(*model_, runs_, options_, folder / (std::string(name) + ".mp4"));
    }
    for (int n = 0; n <= 10; ++n) {
      const std::string frame =
          "frame_0000" + std::string(n < 10 ? "0" : "") + std::to_string(n) + ".png";
      EXPECT_EQ(ReadTextFile(folder / "a" / frame), ReadTextFile(folder / "b" / frame));
    }
    EXPECT_EQ(ReadTextFile(folder / "a.mp4"), ReadTextFile(folder / "b.mp4"));
    EXPECT_NE(ReadTextFile(folder / "a" / "frame_000004.png"),
              ReadTextFile(folder / "a" / "frame_000005.png"));
  }
}

TEST_F(Clip, ShowsTheDiagnosisAsItStoodAtTheTime) {
  options_.picture.diagnosis = test::Overlay();
  const cv::Rect panel = LayOutClip({640, 360}, 2, 1, {true, false, 1}).diagnosis->area;
  const auto still = [&](double time, const DiagnosisOverlay& overlay) {
    PictureOptions picture = options_.picture;
    picture.diagnosis = overlay;
    RenderStill(*model_, runs_, picture, time, folder_ / "still.png");
    return cv::imread((folder_ / "still.png").string())(panel).clone();
  };
  DiagnosisOverlay later = test::Overlay();
  for (EstimateHistory& history : later.estimates) {
    // From 60 ms on, but for the last: the axis reaches as far as before.
    history.value.segment(history.value.size() - 5, 4).setConstant(history.healthy);
  }
  const auto difference = [&](double time) {
    return cv::norm(still(time, test::Overlay()), still(time, later), cv::NORM_INF);
  };
  EXPECT_EQ(difference(0.03), 0.0);
  EXPECT_GT(difference(0.07), 50.0);
}

TEST_F(Clip, GhostShowsTheHealthyMachineInTheFaultyOnesView) {
  options_.picture.ghost = true;
  options_.picture.path_site = "none";
  const auto still = [&](const Record& other) {
    const std::array runs{ClipRun{"Healthy", &healthy_}, ClipRun{"Faulty", &other}};
    RenderStill(*model_, runs, options_.picture, 0.03, folder_ / "still.png");
    return cv::imread((folder_ / "still.png").string())(cv::Rect(160, 120, 320, 140))
        .clone();
  };
  // Bluish where the ghost shines through: nowhere if nothing differs.
  const auto ghostly = [](const cv::Mat& picture) {
    int count = 0;
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const auto& bgr = picture.at<cv::Vec3b>(y, x);
        count += bgr[0] > bgr[2] + 60 && bgr[1] > bgr[2] + 30 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_GT(ghostly(still(faulty_)), ghostly(still(healthy_)) + 100);
}

TEST_F(Clip, SaysByHowMuchTheMotionOfEveryJointIsEnlarged) {
  options_.picture.amplify = {{"mount", 3000.0}};
  const ClipSummary summary =
      RenderClip(*model_, runs_, options_, folder_ / "clip.mp4");
  EXPECT_EQ(summary.amplification.at("mount"), 3000.0);
  EXPECT_GE(summary.amplification.at("stage"), 1.0);
  EXPECT_EQ(summary.amplification.size(), static_cast<std::size_t>(model_->njnt));
  EXPECT_EQ(RenderStill(*model_, runs_, options_.picture, 0.05, folder_ / "still.png"),
            summary.amplification);
}

TEST_F(Clip, GhostNeedsTwoRuns) {
  options_.picture.ghost = true;
  const std::array alone{runs_[0]};
  EXPECT_THAT(test::MessageOf<InputError>(
                  [&] { RenderClip(*model_, alone, options_, folder_ / "clip.mp4"); }),
              HasSubstr("ghost: of 1 runs"));
  EXPECT_EQ(folder_.size(), 0);
}

TEST_F(Clip, ChecksThePictureBeforeThereAreRuns) {
  const auto refusal = [&](const PictureOptions& picture) {
    return test::MessageOf<InputError>([&] { CheckPicture(*model_, picture); });
  };
  EXPECT_NO_THROW(CheckPicture(*model_, options_.picture));
  PictureOptions picture = options_.picture;
  picture.camera = "side";
  EXPECT_THAT(refusal(picture), HasSubstr("one of: front, top"));
  picture = options_.picture;
  picture.path_site = "toe";
  EXPECT_THAT(refusal(picture), HasSubstr("one of: none, corner, elbow, tip"));
  picture = options_.picture;
  picture.width = 100001;
  EXPECT_THAT(refusal(picture), HasSubstr("width: 100001 px"));
  picture = options_.picture;
  picture.begin = 0.05;
  picture.end = 0.05;
  EXPECT_THAT(refusal(picture), HasSubstr("begin before end"));
}

TEST_F(Clip, FramesReplaceThoseOfALongerClip) {
  options_.frames = folder_ / "frames";
  RenderClip(*model_, runs_, options_, folder_ / "clip.mp4");
  options_.picture.end = 0.05;
  EXPECT_EQ(RenderClip(*model_, runs_, options_, folder_ / "clip.mp4").frames, 6);
  EXPECT_TRUE(std::filesystem::exists(options_.frames / "frame_000005.png"));
  EXPECT_FALSE(std::filesystem::exists(options_.frames / "frame_000006.png"));
}

TEST_F(Clip, StillIsTheClipsFrameButForTheSpeed) {
  const auto file = folder_ / "still.png";
  RenderStill(*model_, runs_, options_.picture, 0.05, file);
  const cv::Mat still = cv::imread(file.string());
  EXPECT_EQ(still.size(), cv::Size(640, 360));
  options_.frames = folder_ / "frames";
  RenderClip(*model_, runs_, options_, folder_ / "clip.mp4");
  const cv::Mat frame = cv::imread((options_.frames / "frame_000005.png").string());
  const cv::Rect below_header(0, 40, 640, 320);
  EXPECT_EQ(cv::norm(still(below_header), frame(below_header), cv::NORM_INF), 0.0);
}

TEST_F(Clip, ShowsTheFaultyRunDifferently) {
  const auto file = folder_ / "still.png";
  RenderStill(*model_, runs_, options_.picture, 0.03, file);
  const cv::Mat still = cv::imread(file.string());
  // Below titles and readouts, above the charts.
  const cv::Mat left = still(cv::Rect(0, 120, 319, 140));
  const cv::Mat right = still(cv::Rect(321, 120, 319, 140));
  EXPECT_GT(cv::norm(left, right, cv::NORM_INF), 50.0);
}

TEST_F(Clip, WorksWithoutTrackedAxes) {
  Record joints(1e-3);
  for (const char* name : {"joint.mount", "joint.stage", "joint.tilt", "joint.arm"}) {
    joints.Add(healthy_.At(name));
  }
  const std::array runs{ClipRun{"Open loop", &joints}};
  RenderStill(*model_, runs, options_.picture, 0.05, folder_ / "still.png");
  EXPECT_FALSE(cv::imread((folder_ / "still.png").string()).empty());
}

TEST_F(Clip, LeavesNothingBehindWhenItFailsMidway) {
  options_.frames = folder_ / "frames";
  options_.progress = [](double fraction) {
    if (fraction > 0.5) throw NumericalError("stop");
  };
  EXPECT_THROW(RenderClip(*model_, runs_, options_, folder_ / "clip.mp4"),
               NumericalError);
  EXPECT_EQ(folder_.size(), 0);
}

TEST_F(Clip, NamesWhatIsWrongAndWritesNothing) {
  const auto file = folder_ / "clip.mp4";
  ClipOptions camera = options_;
  camera.picture.camera = "side";
  EXPECT_THAT(Failure(camera, file), HasSubstr("one of: front, top"));
  ClipOptions axis = options_;
  axis.picture.axes = {"y"};
  EXPECT_THAT(Failure(axis, file), HasSubstr("no channel \"y\""));
  ClipOptions range = options_;
  range.picture.end = 3.0;
  EXPECT_THAT(Failure(range, file), HasSubstr("time range"));
  ClipOptions speed = options_;
  speed.speed = 0.0;
  EXPECT_THAT(Failure(speed, file), HasSubstr("speed"));
  ClipOptions size = options_;
  size.picture.width = 641;
  EXPECT_THAT(Failure(size, file), HasSubstr("641 px"));
  EXPECT_THAT(Failure(options_, folder_ / "clip.avi"), HasSubstr(".mp4"));
  EXPECT_NE(Failure(options_, folder_ / "none" / "clip.mp4"), "");
  EXPECT_EQ(folder_.size(), 0);
}

TEST_F(Clip, NamesTheJointThatARunLacks) {
  Record incomplete(1e-3);
  incomplete.Add(healthy_.At("joint.mount"));
  const std::array runs{runs_[0], ClipRun{"Faulty", &incomplete}};
  try {
    RenderStill(*model_, runs, options_.picture, 0.05, folder_ / "still.png");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"x\""));
  }
  PictureOptions no_axes = options_.picture;
  Record joints(1e-3);
  joints.Add(healthy_.At("joint.mount"));
  const std::array only{ClipRun{"Open loop", &joints}};
  try {
    RenderStill(*model_, only, no_axes, 0.05, folder_ / "still.png");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"joint.stage\""));
  }
  EXPECT_EQ(folder_.size(), 0);
}

TEST(ClipWriter, LeavesNothingWithoutFinish) {
  const test::TemporaryFolder folder;
  {
    ClipWriter writer(folder / "clip.mp4", 320, 240, 30.0, folder / "frames");
    const std::vector<std::uint8_t> grey(std::size_t{3} * 320 * 240, 100);
    for (int i = 0; i < 20; ++i) writer.Write({320, 240, grey});
  }
  EXPECT_EQ(folder.size(), 0);
}

}  // namespace
}  // namespace mjdiag
