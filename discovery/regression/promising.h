#pragma once
// The most promising variations of every block along what a model leaves of a run, and along
// what it would leave without some of its members: what could be in their place.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/regression/row_map.h"

namespace mjdiag {

/// A model without some of its members, of none of them the model itself, whitened.
struct WhitenedModel {
  Eigen::VectorXd left;
  std::vector<Eigen::Index> in;       ///< columns that are in
  std::vector<Eigen::Index> removed;  ///< of those that are not
};

/// Models behind one noise.
struct WhitenedModels {
  const RowMap& map;
  Eigen::MatrixXd W;   ///< whitened columns of the model, rows x k
  Eigen::VectorXd sd;  ///< of their amplitudes beforehand
  /// The first is the model itself.
  std::vector<WhitenedModel> models;
  double least = 0.0;  ///< what is to be gained, beside prices
};

/// Behind all of some noises: what blocks do is made once.
/// @param may_come  which blocks are looked at
/// @param blocks    receive the prices of their shapes
std::vector<Variation> PromisingVariations(
    const Machine& machine, const BlockMotion& along,
    const std::vector<WhitenedModels>& behind, std::vector<Block>& blocks,
    const std::function<bool(const Block&)>& may_come);

}  // namespace mjdiag
