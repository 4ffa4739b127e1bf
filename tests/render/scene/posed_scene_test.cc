#include "mjdiag/render/scene/posed_scene.h"

#include <gtest/gtest.h>

#include <vector>

#include "render/test_machine.h"

namespace mjdiag {
namespace {

std::vector<int> GeomsOf(const PosedScene& scene) {
  std::vector<int> geoms;
  geoms.reserve(static_cast<std::size_t>(scene.get().ngeom));
  for (int i = 0; i < scene.get().ngeom; ++i) {
    geoms.push_back(scene.get().geoms[i].objid);
  }
  return geoms;
}

const char* const kThreeInARow =
    "<geom type='plane' size='1 1 1' pos='0 0 -1'/>"
    "<body pos='0 2 0'><joint type='slide' axis='0 1 0'/><geom size='0.1'/></body>"
    "<geom type='box' size='0.1 0.1 0.1' pos='0 1 0'/>"
    "<geom type='box' size='0.1 0.1 0.1'/>";

TEST(PosedScene, IsDrawnFromNearToFarPlanesLast) {
  const ModelPtr model = test::ModelInView(kThreeInARow);
  const DataPtr data = MakeData(*model);
  PosedScene scene(*model, "front");
  scene.Show(*data);
  // The model lists the geoms of the world first: plane, far box, near box, sphere.
  EXPECT_EQ(GeomsOf(scene), (std::vector{2, 1, 3, 0}));
}

TEST(PosedScene, KeepsItsOrderWhileTheMachineMoves) {
  const ModelPtr model = test::ModelInView(kThreeInARow);
  const DataPtr data = MakeData(*model);
  PosedScene scene(*model, "front");
  scene.Show(*data);
  const std::vector<int> before = GeomsOf(scene);
  data->qpos[0] = -2.5;  // the sphere in front of both boxes
  scene.Show(*data);
  EXPECT_EQ(GeomsOf(scene), before);
}

}  // namespace
}  // namespace mjdiag
