#pragma once
// A linear map of columns (column.h) to rows in which what is left of a run is white noise of
// variance 1 and what is missing: what a regression looks at.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"

namespace mjdiag {

class RowMap {
 public:
  virtual ~RowMap() = default;

  virtual Eigen::Index rows() const = 0;
  /// What the machine of the path leaves of the run, rows.
  virtual const Eigen::VectorXd& left() const = 0;
  /// Of the noise, ln.
  virtual double log_determinant() const = 0;

  /// W times every column, rows x columns.
  virtual Eigen::MatrixXd Of(const std::vector<const Column*>& columns) const = 0;

  /// W^T u: the inner product of u with W times a column of forces and errors of readings
  /// is that of this with the column.
  struct Transposed {
    Eigen::MatrixXd forces;    ///< samples x nv
    Eigen::MatrixXd readings;  ///< samples x ny
    /// What of the inner product with a column comes from every sample.
    Eigen::VectorXd Along(const Column& column) const;
    double Times(const Column& column) const;
  };
  /// Of every column of u, rows x any.
  virtual std::vector<Transposed> TransposedTimes(const Eigen::MatrixXd& u) const = 0;
};

}  // namespace mjdiag
