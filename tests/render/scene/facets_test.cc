#include "mjdiag/render/scene/facets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mjdiag/render/scene/posed_scene.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

constexpr Facets kMany{1000, 1000};

double OutlineError(double radius, int pieces) {
  return radius * (1.0 - std::cos(std::numbers::pi / pieces));
}

TEST(Facets, KeepTheOutlineWithinHalfAPixelWithTheFewest) {
  for (const int height : {500, 2000}) {
    const ModelPtr model = test::ModelInView(
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
  const ModelPtr model =
      test::ModelInView("<geom type='ellipsoid' size='0.1 0.1 0.4'/>");
  const PosedScene scene(*model, "front");
  const Facets facets = FacetsThatShow(scene.get(), 2000, {28, 16});
  EXPECT_EQ(facets.slices, 28);
  EXPECT_EQ(facets.stacks, 16);
}

TEST(Facets, AreNotSpentOnWhatTheCameraDoesNotSee) {
  const ModelPtr model =
      test::ModelInView("<geom type='sphere' size='0.4' pos='0 -3 0'/>");
  const PosedScene scene(*model, "front");
  EXPECT_LT(FacetsThatShow(scene.get(), 2000, kMany).slices, 10);
}

}  // namespace
}  // namespace mjdiag
