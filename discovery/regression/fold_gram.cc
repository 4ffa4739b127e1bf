#include "mjdiag/discovery/regression/fold_gram.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FoldGram GramOf(const Whitening& whitening, const std::vector<const Column*>& columns,
                int folds) {
  const Index rows = whitening.rows();
  MatrixXd all(rows, 1 + std::ssize(columns));
  all.col(0) = whitening.left();
  all.rightCols(std::ssize(columns)) = whitening.Of(columns);
  FoldGram gram;
  gram.log_determinant = whitening.log_determinant();
  gram.sum = MatrixXd::Zero(all.cols(), all.cols());
  for (Index fold = 0; fold < folds; ++fold) {
    const Index first = fold * rows / folds;
    const auto part = all.middleRows(first, (fold + 1) * rows / folds - first);
    MatrixXd one = MatrixXd::Zero(all.cols(), all.cols());
    one.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
    one.triangularView<Eigen::Upper>() = one.transpose();
    gram.sum += one;
    gram.folds.push_back(std::move(one));
  }
  return gram;
}

SetFit FitSet(const FoldGram& gram, const std::vector<Index>& columns,
              const VectorXd& sd) {
  const Index n = std::ssize(columns);
  SetFit fit;
  fit.unseen = gram.log_determinant;
  fit.amplitudes.resize(0);
  if (n == 0) {
    fit.unseen += gram.sum(0, 0);
    return fit;
  }
  std::vector<Index> places;
  for (const Index column : columns) places.push_back(1 + column);
  // In units of what is known beforehand.
  const auto part = [&](const MatrixXd& of) -> MatrixXd {
    return sd.asDiagonal() * of(places, places) * sd.asDiagonal();
  };
  const auto product = [&](const MatrixXd& of) -> VectorXd {
    return sd.cwiseProduct(of(places, 0));
  };
  const MatrixXd G = part(gram.sum);
  const VectorXd b = product(gram.sum);
  const MatrixXd I = MatrixXd::Identity(n, n);
  const Eigen::LLT<MatrixXd> whole(G + I);
  fit.amplitudes = sd.cwiseProduct(whole.solve(b));
  fit.sd = sd.cwiseProduct(whole.solve(I).diagonal().cwiseSqrt());
  for (const MatrixXd& fold : gram.folds) {
    const MatrixXd Gf = part(fold);
    const VectorXd bf = product(fold);
    const VectorXd a = Eigen::LLT<MatrixXd>(G - Gf + I).solve(b - bf);
    fit.unseen += fold(0, 0) - 2.0 * a.dot(bf) + a.dot(Gf * a);
  }
  return fit;
}

}  // namespace mjdiag
