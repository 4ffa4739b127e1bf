#pragma once
// How finely curved geoms are drawn. A processor that draws facet by facet feels every
// one, so there are as many as the picture shows and no more.

#include <mujoco/mujoco.h>

namespace mjdiag {

/// Flat pieces round a circle, and from pole to pole of a sphere.
struct Facets {
  int slices = 0;
  int stacks = 0;
};

/// The fewest facets that keep the outline of every geom of the scene within kChord of
/// the true curve: n pieces round a circle of R pixels leave R (1 - cos(pi / n)).
/// @param height  of the picture [px]
/// @param most    never more than these
Facets FacetsThatShow(const mjvScene& scene, int height, const Facets& most);

}  // namespace mjdiag
