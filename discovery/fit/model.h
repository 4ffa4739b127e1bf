#pragma once
// A model of what a machine lacks: members, which are blocks (block.h) with values; and the
// coordinates x in which they are fitted, those in which what is known beforehand has a
// standard deviation of 1 and in which what acts alike lies on a straight line,
//
//   theta = u x         of sizes, u the spread that is expected
//   theta = exp(u x)    of factors, by their spread, and of what shapes a law; u of a
//                       period or a frequency is a radian of its phase along all that was
//                       seen

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

struct Member {
  std::size_t block = 0;
  Eigen::VectorXd values;  ///< of the law's parameters, or the number's factor
};
using Model = std::vector<Member>;

/// What it does to the plant.
Changes ChangesOfModel(const std::vector<Block>& blocks, const Model& model);
/// Without the member at a place.
Model Without(Model model, std::size_t place);
/// The same blocks, in any order.
bool HaveSameBlocks(const Model& a, const Model& b);
/// The same blocks in the same order with values that differ by that share at most.
bool AreNear(const Model& a, const Model& b, double share);
/// Whether members of one block can be told apart along what was seen: waves that differ by
/// a turn of their phase (Rayleigh's criterion), resonances that do by both their half
/// widths, zeta f. Two that are closer are one, of another shape.
bool IsResolved(const std::vector<Block>& blocks, const Model& model);
/// "coulomb_friction@load(20.4), mass@stage(1.02)".
std::string ModelText(const std::vector<Block>& blocks, const Model& model);

struct Coordinate {
  std::size_t member = 0;
  Eigen::Index value = 0;  ///< of the member
  bool is_log = false;
  double unit = 1.0;
  /// Whether it is known beforehand to be about 0, with a standard deviation of 1. What
  /// shapes a law may be anything.
  bool is_known = false;
  double lower = 0.0;
  double upper = 0.0;

  double ToX(double theta) const;
  /// From x to a place near by, within the bounds, for a difference.
  double Step(double x) const;
  double ToTheta(double x) const;
};

/// Of all values that a fit may change, member by member.
std::vector<Coordinate> CoordinatesOf(const std::vector<Block>& blocks,
                                      const Model& model);
Eigen::VectorXd Place(const std::vector<Coordinate>& coordinates, const Model& model);
Model At(const std::vector<Coordinate>& coordinates, Model model,
         const Eigen::VectorXd& x);
/// With one coordinate a step from where it is (Coordinate::Step), for a difference.
struct MovedOnce {
  Model model;
  double step = 0.0;
};
MovedOnce Moved(const std::vector<Coordinate>& coordinates, const Model& model,
                Eigen::Index place);

/// What makes coordinates white as they are known beforehand: nothing, but for the knots of a
/// curve (WhiteningOfKnots). Upper triangular.
Eigen::MatrixXd WhiteningOf(const std::vector<Block>& blocks, const Model& model,
                            const std::vector<Coordinate>& coordinates);

}  // namespace mjdiag
