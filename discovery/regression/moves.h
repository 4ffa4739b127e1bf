#pragma once
// How a model of what a machine lacks may change for the better: members that leave it,
// blocks that come in, and both at once, by one regression along the path of the machine
// with the model as it is,
//
//   score = -2 ln p(unseen folds) + what is known beforehand of sizes + prices,
//
// behind the noise that suits each best: a model that is right deserves smaller latent
// forces. What members do by their coordinates and what they would leave when taken out are
// exact columns; what blocks would do is that of first order.
//
// All shapes of all laws are looked at along what the model leaves: inner products with W^T
// of it say how much each would take away, and W^T of white noise how large each is behind
// the filter, |W f|^2 = E (f . W^T n)^2. The most promising of every block are then whitened
// themselves.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/regression/row_map.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// What is in already: a member of the model.
struct Term {
  std::size_t block = 0;
  std::vector<Column> columns;  ///< by every coordinate of it
  Eigen::VectorXd sd;           ///< of what is still to be added to each
  Eigen::VectorXd mean;
  std::vector<bool> known;  ///< whether `mean` is where it is known to be, within 1
  Column removed;           ///< what the machine would do without it
};

struct Added {
  Variation variation;
  Eigen::VectorXd amplitudes;
};

struct ModelMove {
  std::vector<std::size_t> removed;  ///< places of terms
  std::vector<Added> added;
  double score = 0.0;
  std::size_t noise = 0;     ///< the map behind which it is best
  bool other_steps = false;  ///< with what the machine does with other physics steps
};

struct Moves {
  double score = 0.0;     ///< of the model as it is
  std::size_t noise = 0;  ///< the map behind which it is best
  bool other_steps = false;
  std::vector<ModelMove> best;  ///< by score, no two with the same blocks
  /// Those that are worse than the model as it is, by kNear at most: what could be in its
  /// place.
  std::vector<ModelMove> near;
  Eigen::Index variations = 0;
};

/// What may come in.
struct Looked {
  bool at_forces = false;  ///< what acts along the motion only
  /// Resistances of every shape, also where the simplest of their kind is not in.
  bool at_every_shape = false;
  /// Inputs were measured with noise: a machine that did not feel it looks heavy.
  bool inputs_are_noise = false;
};

/// @param maps         of the path, behind one noise each
/// @param blocks       receive the prices of their shapes
/// @param other_steps  what the machine does otherwise with other physics steps, which costs
///                     nothing
Moves MovesOf(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
              const std::vector<const RowMap*>& maps, std::vector<Block>& blocks,
              const std::vector<Term>& terms, const Column& other_steps, Looked looked);

/// A model that is worse by that is less than e^-10 times as likely.
inline constexpr double kNear = 20.0;

/// Less gain, in -2 ln, is noise of fits.
inline constexpr double kLeastGain = 1.0;

}  // namespace mjdiag
