#pragma once
// Columns and what is left of a run, whitened behind one noise of the model, as Gram
// matrices of folds: some many parts of the run, one after the other.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/discovery/regression/row_map.h"

namespace mjdiag {

struct FoldGram {
  /// Of every fold, (1 + columns)^2: what is left first.
  std::vector<Eigen::MatrixXd> folds;
  Eigen::MatrixXd sum;
  double log_determinant = 0.0;
};

FoldGram GramOf(const RowMap& map, const std::vector<const Column*>& columns,
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

/// What some of the amplitudes of a fit are worth, a^T Cov^-1 a, with their covariance or,
/// where it is larger, that which differences between folds say,
///
///   H^-1 (sum_f g_f g_f^T) H^-1,   g_f = b_f - G_f a      [Huber 1967]
///
/// What one event in one fold asks for and the others do not is worth about 1.
/// @param first, count  places of the columns in the set
double WorthOf(const FoldGram& gram, const SetOfColumns& set, const SetFit& fit,
               Eigen::Index first, Eigen::Index count);

}  // namespace mjdiag
