#pragma once
// The most promising variations of every block along what a model leaves of a run.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/regression/row_map.h"

namespace mjdiag {

/// @param may_come  which blocks are looked at
/// @param left    what is left, whitened
/// @param W       whitened columns that are in, rows x k
/// @param sd      of their amplitudes beforehand
/// @param blocks  receive the prices of their shapes
std::vector<Variation> PromisingVariations(
    const Machine& machine, const BlockMotion& along, const RowMap& map,
    const Eigen::VectorXd& left, const Eigen::MatrixXd& W, const Eigen::VectorXd& sd,
    std::vector<Block>& blocks, const std::function<bool(const Block&)>& may_come);

}  // namespace mjdiag
