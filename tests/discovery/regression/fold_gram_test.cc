#include "mjdiag/discovery/regression/fold_gram.h"

#include <gtest/gtest.h>

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFolds = 20;

/// One column of norm 1 in every fold, and its product with what is left there.
FoldGram GramWith(const VectorXd& products) {
  FoldGram gram;
  gram.sum = MatrixXd::Zero(2, 2);
  for (const double product : products) {
    MatrixXd fold(2, 2);
    fold << 1.0, product, product, 1.0;
    gram.folds.push_back(fold);
    gram.sum += fold;
  }
  return gram;
}

double WorthIn(const FoldGram& gram) {
  const SetOfColumns set{{0}, VectorXd::Constant(1, 1e3), VectorXd::Zero(1), {}, {}};
  return WorthOf(gram, set, FitSet(gram, set), 0, 1);
}

// Both have the same amplitude, 1, and the same gain in the sum, 20.
TEST(WorthOf, IsTheGainWhereAllFoldsSayTheSame) {
  EXPECT_NEAR(WorthIn(GramWith(VectorXd::Ones(kFolds))), kFolds, 0.01);
}

TEST(WorthOf, IsAboutOneWhereOneFoldSaysItAlone) {
  VectorXd products = VectorXd::Zero(kFolds);
  products[3] = kFolds;
  // 400 / (20 / 19 (19^2 + 19)) = 1
  EXPECT_NEAR(WorthIn(GramWith(products)), 1.0, 0.01);
}

}  // namespace
}  // namespace mjdiag
