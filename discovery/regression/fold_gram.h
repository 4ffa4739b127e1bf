#pragma once
// Columns and what is left of a run, whitened behind one noise of the model, as Gram
// matrices of folds: some many parts of the run, one after the other.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/discovery/regression/whitening.h"

namespace mjdiag {

struct FoldGram {
  /// Of every fold, (1 + columns)^2: what is left first.
  std::vector<Eigen::MatrixXd> folds;
  Eigen::MatrixXd sum;
  double log_determinant = 0.0;
};

FoldGram GramOf(const Whitening& whitening, const std::vector<const Column*>& columns,
                int folds);

/// Columns that are in, with what is known of their amplitudes beforehand, and others that
/// are in as they are, with an amplitude of 1.
struct SetOfColumns {
  std::vector<Eigen::Index>
      columns;  ///< places in the Gram matrix, without the first row
  Eigen::VectorXd sd;
  Eigen::VectorXd mean;
  std::vector<Eigen::Index> given;
  /// Of the first ones: whether `mean` is where they are known to be, with a standard
  /// deviation of 1.
  std::vector<bool> known{};
};

/// What a set of columns says behind a noise.
struct SetFit {
  Eigen::VectorXd amplitudes;
  Eigen::VectorXd sd;  ///< of them, given the data
  /// -2 ln of how dense the folds are predicted that a fit did not see, each from all of the
  /// others, but for a constant.
  double unseen = 0.0;
};

SetFit FitSet(const FoldGram& gram, const SetOfColumns& set);

}  // namespace mjdiag
