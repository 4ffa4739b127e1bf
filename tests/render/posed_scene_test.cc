#include "mjdiag/render/posed_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mjdiag/plugin/mujoco_model.h"
#include "mjdiag/render/facets.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

// A camera at y = -1 that looks along y, with a field of view of 2 atan(1/2): at a
// distance d [m] a picture h pixels high is d [m] high.
ModelPtr ModelOf(const std::string& bodies) {
  const test::TemporaryFolder folder;
  return LoadModel(
      folder.Write("model.xml",
                   "<mujoco><worldbody>"
                   "<camera name='front' pos='0 -1 0' xyaxes='1 0 0 0 0 1' "
                   "fovy='53.13010235415598'/>" +
                       bodies + "</worldbody></mujoco>"));
}

constexpr Facets kMany{1000, 1000};

double OutlineError(double radius, int pieces) {
  return radius * (1.0 - std::cos(std::numbers::pi / pieces));
}

TEST(Facets, KeepTheOutlineWithinHalfAPixelWithTheFewest) {
  for (const int height : {500, 2000}) {
    const ModelPtr model = ModelOf(
        "<geom type='sphere' size='0.02'/>"
        "<geom type='cylinder' size='0.1 0.3' pos='0 1 0'/>");
    const PosedScene scene(*model, "front");
    const Facets facets = FacetsThatShow(scene.get(), height, kMany);
    const double sphere = 0.02 * height;
    const double cylinder = 0.1 * height / 2.0;
    EXPECT_LE(OutlineError(cylinder, facets.slices), 0.5) << height;
    EXPECT_GT(OutlineError(cylinder, facets.slices - 2), 0.5) << height;
    EXPECT_LE(OutlineError(sphere, 2 * facets.stacks), 0.5) << height;
    EXPECT_GT(OutlineError(sphere, 2 * (facets.stacks - 1)), 0.5) << height;
  }
}

TEST(Facets, AreNeverMoreThanTheModelHas) {
  const ModelPtr model = ModelOf("<geom type='ellipsoid' size='0.1 0.1 0.4'/>");
  const PosedScene scene(*model, "front");
  const Facets facets = FacetsThatShow(scene.get(), 2000, {28, 16});
  EXPECT_EQ(facets.slices, 28);
  EXPECT_EQ(facets.stacks, 16);
}

TEST(Facets, AreNotSpentOnWhatTheCameraDoesNotSee) {
  const ModelPtr model = ModelOf("<geom type='sphere' size='0.4' pos='0 -3 0'/>");
  const PosedScene scene(*model, "front");
  EXPECT_LT(FacetsThatShow(scene.get(), 2000, kMany).slices, 10);
}

std::vector<int> GeomsOf(const PosedScene& scene) {
  std::vector<int> geoms;
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
  const ModelPtr model = ModelOf(kThreeInARow);
  const DataPtr data = MakeData(*model);
  PosedScene scene(*model, "front");
  scene.Show(*data);
  // The model lists the geoms of the world first: plane, far box, near box, sphere.
  EXPECT_EQ(GeomsOf(scene), (std::vector{2, 1, 3, 0}));
}

TEST(PosedScene, KeepsItsOrderWhileTheMachineMoves) {
  const ModelPtr model = ModelOf(kThreeInARow);
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
