#include "mjdiag/render/site_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/render/scene/scene_renderer.h"
#include "mjdiag/signals/error.h"
#include "render/test_machine.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

TEST(SitePath, TakesTheLastSiteOfTheFarthestBodyForTheTool) {
  const ModelPtr model = test::Machine();
  EXPECT_EQ(ToolSite(*model), mj_name2id(model.get(), mjOBJ_SITE, "tip"));
  EXPECT_EQ(PathSite(*model, ""), ToolSite(*model));
  EXPECT_EQ(PathSite(*model, "none"), std::nullopt);
  EXPECT_EQ(PathSite(*model, "corner"), mj_name2id(model.get(), mjOBJ_SITE, "corner"));
}

TEST(SitePath, ListsTheSitesWhenOneIsUnknown) {
  const ModelPtr model = test::Machine();
  EXPECT_THAT(test::MessageOf<InputError>([&] { PathSite(*model, "toe"); }),
              HasSubstr("one of: none, corner, elbow, tip"));
}

TEST(SitePath, FollowsTheAmplifiedMotionOverTheTimesShown) {
  const ModelPtr model = test::Machine();
  const Record healthy = test::Run({});
  const Record faulty = test::Run({.stage = 4e-6});
  const std::array runs{&healthy, &faulty};
  const TimeRange range{0.02, 0.06};
  const Amplification amplification(DrawnJoints(*model), healthy, runs, range,
                                    {.drawn_length = 0.02, .drawn_angle = 0.05});
  const DataPtr data = MakeData(*model);
  const int tip = *ToolSite(*model);
  const SitePath path = DrawnPath(*model, tip, amplification, faulty, range, *data);
  ASSERT_EQ(path.times.size(), 41u);
  EXPECT_NEAR(path.times.front(), 0.02, 1e-12);
  EXPECT_NEAR(path.times.back(), 0.06, 1e-12);
  SetPositions(*model, amplification.DrawnPositions(faulty, 0.033), *data);
  mj_kinematics(model.get(), data.get());
  EXPECT_TRUE(path.positions[13].isApprox(
      Eigen::Map<const Eigen::Vector3d>(RowOf(data->site_xpos, 3, tip)), 1e-12));
  // The fault moves the tip by millimetres on the picture, not by micrometres.
  const SitePath nominal = DrawnPath(*model, tip, amplification, healthy, range, *data);
  EXPECT_GT((path.positions[10] - nominal.positions[10]).norm(), 2e-3);
}

TEST(SitePath, LiesWhereThePictureShowsTheSite) {
  // The site alone, as a red ball; the camera of the machine looks at it aslant.
  std::string mjcf = test::kMachine;
  const std::string tip = R"(<site name="tip" pos="0.08 0 0" group="4"/>)";
  mjcf.replace(mjcf.find(tip), tip.size(),
               R"(<site name="tip" pos="0.08 0 0" size="0.012" rgba="1 0 1 1"/>)");
  const test::TemporaryFolder folder;
  const ModelPtr model = LoadModel(folder.Write("machine.xml", mjcf));
  const DataPtr data = MakeData(*model);
  for (const char* camera : {"front", "top", ""}) {
    SceneRenderer renderer(*model, {.width = 320, .height = 200, .camera = camera});
    data->qpos[1] = 0.06;
    Image image;
    renderer.Render(*data, image);
    double count = 0.0;
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const auto* rgb = &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)];
        if (rgb[0] < 60 || rgb[1] > 0.5 * rgb[0] || rgb[2] < 0.8 * rgb[0]) continue;
        centre += Eigen::Vector2d(x + 0.5, y + 0.5);
        count += 1.0;
      }
    }
    ASSERT_GT(count, 10.0) << camera;
    const auto pixel = renderer.projection()(Eigen::Map<const Eigen::Vector3d>(
        RowOf(data->site_xpos, 3, mj_name2id(model.get(), mjOBJ_SITE, "tip"))));
    ASSERT_TRUE(pixel.has_value());
    EXPECT_LT((*pixel - centre / count).norm(), 3.0) << camera;
  }
}

}  // namespace
}  // namespace mjdiag
