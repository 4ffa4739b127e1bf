#include "mjdiag/signals/wide_product.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows of one, some and many registers, and of a remainder of every size.
constexpr std::array<Index, 8> kRows = {8, 16, 24, 32, 40, 48, 56, 136};

TEST(WideProduct, HasWholeRegisters) {
  EXPECT_EQ(WideRows(0), 0);
  EXPECT_EQ(WideRows(1), 8);
  EXPECT_EQ(WideRows(8), 8);
  EXPECT_EQ(WideRows(23), 24);
}

TEST(WideProduct, SumsColumnByColumnOnEveryProcessor) {
  for (const WideProducts& wide : WideProductsHere()) {
    SCOPED_TRACE(wide.processor);
    for (const Index rows : kRows) {
      const MatrixXd matrix = MatrixXd::Random(rows, 23);
      const VectorXd x = VectorXd::Random(23);
      VectorXd expected = VectorXd::Zero(rows);
      for (Index j = 0; j < x.size(); ++j) {
        for (Index i = 0; i < rows; ++i) expected[i] += matrix(i, j) * x[j];
      }
      VectorXd result = VectorXd::Constant(rows, 7.0);
      wide.product(matrix, x.data(), result.data());
      EXPECT_EQ(result, expected) << rows << " rows";
      WideProduct(matrix, x.data(), result.data());
      EXPECT_EQ(result, expected) << rows << " rows";
    }
  }
}

TEST(WideProduct, OfNoColumnsIsZero) {
  const MatrixXd matrix(16, 0);
  for (const WideProducts& wide : WideProductsHere()) {
    VectorXd result = VectorXd::Constant(16, 7.0);
    wide.product(matrix, nullptr, result.data());
    EXPECT_EQ(result, VectorXd::Zero(16)) << wide.processor;
  }
}

TEST(WideProduct, AddsTermsInTheirOrderOnEveryProcessor) {
  const std::vector<WideTerm> terms = {
      {3, 0, 1}, {0, 2, 1}, {1, 1, 1}, {2, 2, 0}, {0, 0, 1}};
  const VectorXd weights = VectorXd::Random(4);
  for (const WideProducts& wide : WideProductsHere()) {
    SCOPED_TRACE(wide.processor);
    for (const Index rows : kRows) {
      const MatrixXd columns = MatrixXd::Random(rows, 3);
      MatrixXd sums = MatrixXd::Random(rows, 2);
      MatrixXd expected = sums;
      MatrixXd chosen = sums;
      for (const WideTerm& term : terms) {
        for (Index i = 0; i < rows; ++i) {
          expected(i, term.into) += weights[term.weight] * columns(i, term.from);
        }
      }
      wide.add(terms, weights.data(), columns, sums);
      EXPECT_EQ(sums, expected) << rows << " rows";
      WideAdd(terms, weights.data(), columns, chosen);
      EXPECT_EQ(chosen, expected) << rows << " rows";
    }
  }
}

}  // namespace
}  // namespace mjdiag
