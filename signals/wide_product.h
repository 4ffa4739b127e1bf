#pragma once
// Products of small matrices with vectors, for what is done every tick: with the widest
// registers that the processor has, and with the same bits on every one. Every entry is
// summed by itself, in the order of the columns, and no product is fused with its sum.
//
// Matrices have rows in whole registers (WideRows); what is beyond those that are wanted is
// 0, or whatever else nobody reads.

#include <Eigen/Core>
#include <span>

namespace mjdiag {

/// Rows up to a whole number of the widest registers.
constexpr Eigen::Index WideRows(Eigen::Index rows) {
  constexpr Eigen::Index kWidest = 8;
  return (rows + kWidest - 1) / kWidest * kWidest;
}

/// `weight` times column `from` is added to column `into`.
struct WideTerm {
  Eigen::Index weight;
  Eigen::Index from;
  Eigen::Index into;
};

/// The same for a kind of processor.
struct WideProducts {
  const char* processor;
  /// result = matrix x. Nothing overlaps.
  /// @param x       matrix.cols() numbers
  /// @param result  matrix.rows() numbers, which are whole registers
  void (*product)(const Eigen::MatrixXd& matrix, const double* x,
                  double* result) noexcept;
  /// All terms in their order; those into one column are best side by side.
  /// @param columns, sums  of as many rows, whole registers
  void (*add)(std::span<const WideTerm> terms, const double* weights,
              const Eigen::MatrixXd& columns, Eigen::MatrixXd& sums) noexcept;
};

/// Those that this processor can, the widest last.
std::span<const WideProducts> WideProductsHere();

// The widest ones.
void WideProduct(const Eigen::MatrixXd& matrix, const double* x,
                 double* result) noexcept;
void WideAdd(std::span<const WideTerm> terms, const double* weights,
             const Eigen::MatrixXd& columns, Eigen::MatrixXd& sums) noexcept;

}  // namespace mjdiag
