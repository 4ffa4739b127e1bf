#include "mjdiag/render/scene/scene_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

SceneOptions Small() { return {.width = 160, .height = 90, .camera = "front"}; }

Image Picture(const mjModel& model, const SceneOptions& options, double stage = 0.0) {
  SceneRenderer renderer(model, options);
  const DataPtr data = MakeData(model);
  data->qpos[1] = stage;
  Image image;
  renderer.Render(*data, image);
  return image;
}

double MeanBrightness(const Image& image, int first_row, int last_row) {
  double sum = 0.0;
  const std::size_t row = 3 * static_cast<std::size_t>(image.width);
  for (std::size_t i = first_row * row; i < last_row * row; ++i) sum += image.rgb[i];
  return sum / static_cast<double>((last_row - first_row) * row);
}

TEST(SceneRenderer, DrawsAtTheRequestedSizeWhateverTheModelSays) {
  const ModelPtr model = test::Machine();
  for (const Smoothing smoothing :
       {Smoothing::kNone, Smoothing::kMultisample4, Smoothing::kSupersample2}) {
    const Image image =
        Picture(*model, {.width = 1500, .height = 1100, .smoothing = smoothing});
    EXPECT_EQ(image.width, 1500);
    EXPECT_EQ(image.height, 1100);
    EXPECT_EQ(image.rgb.size(), 3u * 1500u * 1100u);
    // Rows that an off-screen buffer of the model's own size would leave empty.
    EXPECT_GT(MeanBrightness(image, 0, 50), 100.0);
  }
  EXPECT_EQ(model->vis.global.offwidth, 640);
}

TEST(SceneRenderer, GivesTheSameBytesEveryTime) {
  const ModelPtr model = test::Machine();
  EXPECT_EQ(Picture(*model, Small(), 0.01), Picture(*model, Small(), 0.01));
}

TEST(SceneRenderer, ShowsThatAJointMoved) {
  const ModelPtr model = test::Machine();
  EXPECT_NE(Picture(*model, Small(), 0.0), Picture(*model, Small(), 0.01));
}

TEST(SceneRenderer, HasTheSkyAboveTheGround) {
  const ModelPtr model = test::Machine();
  const Image image = Picture(*model, Small());
  // The backdrop is bluish at the zenith and nearly white at the ground.
  EXPECT_LT(MeanBrightness(image, 0, 15), MeanBrightness(image, 75, 90) - 10.0);
}

TEST(SceneRenderer, TwoOfThemDoNotDisturbEachOther) {
  const ModelPtr model = test::Machine();
  SceneOptions top = Small();
  top.camera = "top";
  // The larger one first: it would not fit into the buffer of the other.
  SceneOptions large = Small();
  large.width *= 2;
  large.height *= 2;
  const Image alone = Picture(*model, large);
  SceneRenderer first(*model, large);
  SceneRenderer second(*model, top);
  const DataPtr data = MakeData(*model);
  Image a;
  Image b;
  second.Render(*data, b);
  first.Render(*data, a);
  EXPECT_EQ(a, alone);
  EXPECT_NE(b, alone);
}

TEST(SceneRenderer, ListsTheCamerasWhenOneIsUnknown) {
  const ModelPtr model = test::Machine();
  SceneOptions options = Small();
  options.camera = "side";
  try {
    SceneRenderer renderer(*model, options);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("\"side\""), HasSubstr("one of: front, top")));
  }
}

TEST(SceneRenderer, RefusesSenselessSizes) {
  const ModelPtr model = test::Machine();
  EXPECT_THROW(SceneRenderer(*model, {.width = 0, .height = 90}), InputError);
  EXPECT_THROW(SceneRenderer(*model, {.width = 160, .height = 100000}), InputError);
}

TEST(SceneRenderer, KnowsTheHeightOfItsView) {
  const ModelPtr model = test::Machine();
  SceneOptions options = Small();
  options.camera = "top";
  SceneRenderer renderer(*model, options);
  const DataPtr data = MakeData(*model);
  // Looking down from 1.2 m with MuJoCo's 45 degrees; the median of the middle third
  // lies on the base (top face at 0.02 m) or on what stands on it, up to 0.15 m.
  const double per_metre = 2.0 * std::tan(std::numbers::pi / 8.0);
  EXPECT_GT(renderer.ViewHeight(*data), 1.05 * per_metre);
  EXPECT_LT(renderer.ViewHeight(*data), 1.19 * per_metre);
}

TEST(SceneRenderer, RunsNoControlCallback) {
  const ModelPtr model = test::Machine();
  static int calls = 0;
  mjcb_control = [](const mjModel*, mjData*) { ++calls; };
  Picture(*model, Small());
  mjcb_control = nullptr;
  EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace mjdiag
