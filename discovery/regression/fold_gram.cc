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
  all.col(0) = whitening.gains().left;
  all.rightCols(std::ssize(columns)) = whitening.Of(columns);
  FoldGram gram;
  gram.log_determinant = whitening.gains().log_determinant;
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

SetFit FitSet(const FoldGram& gram, const SetOfColumns& set) {
  const Index n = std::ssize(set.columns);
  std::vector<Index> places;
  for (const Index column : set.columns) places.push_back(1 + column);
  const VectorXd& sd = set.sd;
  const VectorXd mean = set.mean.cwiseQuotient(sd);
  // In units of what is known beforehand, what is given taken off.
  const auto part = [&](const MatrixXd& of) -> MatrixXd {
    return sd.asDiagonal() * of(places, places) * sd.asDiagonal();
  };
  const auto with_left = [&](const MatrixXd& of) {
    VectorXd column = of.col(0);
    for (const Index given : set.given) column -= of.col(1 + given);
    return column;
  };
  const auto product = [&](const VectorXd& column) -> VectorXd {
    return sd.cwiseProduct(VectorXd(column(places)));
  };
  const auto square = [&](const VectorXd& column) {
    double sum = column[0];
    for (const Index given : set.given) sum -= column[1 + given];
    return sum;
  };
  SetFit fit;
  const MatrixXd G = part(gram.sum);
  const VectorXd b = product(with_left(gram.sum));
  const MatrixXd I = MatrixXd::Identity(n, n);
  const Eigen::LLT<MatrixXd> whole(G + I);
  const VectorXd a = whole.solve(b + mean);
  fit.amplitudes = sd.cwiseProduct(a);
  fit.sd = sd.cwiseProduct(whole.solve(I).diagonal().cwiseSqrt());
  fit.unseen = gram.log_determinant;
  for (const MatrixXd& fold : gram.folds) {
    const VectorXd column = with_left(fold);
    if (n == 0) {
      fit.unseen += square(column);
      continue;
    }
    const MatrixXd Gf = part(fold);
    const VectorXd bf = product(column);
    const VectorXd of_others = Eigen::LLT<MatrixXd>(G - Gf + I).solve(b - bf + mean);
    fit.unseen +=
        square(column) - 2.0 * of_others.dot(bf) + of_others.dot(Gf * of_others);
  }
  return fit;
}

}  // namespace mjdiag
