#include "mjdiag/discovery/regression/fold_gram.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FoldGram GramOf(const RowMap& map, const std::vector<const Column*>& columns,
                int folds) {
  const Index rows = map.rows();
  MatrixXd all(rows, 1 + std::ssize(columns));
  all.col(0) = map.left();
  all.rightCols(std::ssize(columns)) = map.Of(columns);
  FoldGram gram;
  gram.log_determinant = map.log_determinant();
  gram.sum = MatrixXd::Zero(all.cols(), all.cols());
  for (Index fold = 0; fold < folds; ++fold) {
    const Index first = fold * rows / folds;
    const Index end = (fold + 1) * rows / folds;
    if (end == first) continue;  // fewer rows than folds
    const auto part = all.middleRows(first, end - first);
    MatrixXd one = MatrixXd::Zero(all.cols(), all.cols());
    one.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
    one.triangularView<Eigen::Upper>() = one.transpose();
    gram.sum += one;
    gram.folds.push_back(std::move(one));
  }
  return gram;
}

namespace {

/// A set in units of what is known of it beforehand, what is given taken off.
class InUnits {
 public:
  explicit InUnits(const SetOfColumns& set) : set_(set) {
    for (const Index column : set.columns) places_.push_back(1 + column);
  }
  MatrixXd Matrix(const MatrixXd& of) const {
    return set_.sd.asDiagonal() * of(places_, places_) * set_.sd.asDiagonal();
  }
  VectorXd WithLeft(const MatrixXd& of) const {
    VectorXd column = of.col(0);
    for (const Index given : set_.given) column -= of.col(1 + given);
    return column;
  }
  VectorXd Product(const VectorXd& with_left) const {
    return set_.sd.cwiseProduct(VectorXd(with_left(places_)));
  }

 private:
  const SetOfColumns& set_;
  std::vector<Index> places_;
};

}  // namespace

double WorthOf(const FoldGram& gram, const SetOfColumns& set, const SetFit& fit,
               Index first, Index count) {
  const InUnits units(set);
  const Index n = std::ssize(set.columns);
  const VectorXd a = fit.amplitudes.cwiseQuotient(set.sd);
  MatrixXd between = MatrixXd::Zero(n, n);
  for (const MatrixXd& fold : gram.folds) {
    const VectorXd g = units.Product(units.WithLeft(fold)) - units.Matrix(fold) * a;
    between += g * g.transpose();
  }
  const auto folds = static_cast<double>(gram.folds.size());
  between *= folds / std::max(1.0, folds - 1.0);
  const MatrixXd H = units.Matrix(gram.sum) + MatrixXd::Identity(n, n);
  const Eigen::LLT<MatrixXd> solved(H);
  const MatrixXd within = solved.solve(MatrixXd::Identity(n, n));
  const MatrixXd root = solved.solve(between);
  const MatrixXd repeated = solved.solve(root.transpose());
  const VectorXd own = a.segment(first, count);
  const auto worth = [&](const MatrixXd& covariance) {
    const MatrixXd block = covariance.block(first, first, count, count);
    return own.dot(block.ldlt().solve(own));
  };
  if (gram.folds.size() < 2) return worth(within);
  return std::min(worth(within), worth(repeated));
}

SetFit FitSet(const FoldGram& gram, const SetOfColumns& set) {
  const Index n = std::ssize(set.columns);
  const InUnits units(set);
  const VectorXd& sd = set.sd;
  const VectorXd mean = set.mean.cwiseQuotient(sd);
  const auto square = [&](const VectorXd& column) {
    double sum = column[0];
    for (const Index given : set.given) sum -= column[1 + given];
    return sum;
  };
  SetFit fit;
  const MatrixXd G = units.Matrix(gram.sum);
  const VectorXd b = units.Product(units.WithLeft(gram.sum));
  const MatrixXd I = MatrixXd::Identity(n, n);
  const Eigen::LLT<MatrixXd> whole(G + I);
  const VectorXd a = whole.solve(b + mean);
  fit.amplitudes = sd.cwiseProduct(a);
  fit.sd = sd.cwiseProduct(whole.solve(I).diagonal().cwiseSqrt());
  fit.unseen = gram.log_determinant;
  for (const MatrixXd& fold : gram.folds) {
    const VectorXd column = units.WithLeft(fold);
    if (n == 0) {
      fit.unseen += square(column);
      continue;
    }
    const MatrixXd Gf = units.Matrix(fold);
    const VectorXd bf = units.Product(column);
    const VectorXd of_others = Eigen::LLT<MatrixXd>(G - Gf + I).solve(b - bf + mean);
    fit.unseen +=
        square(column) - 2.0 * of_others.dot(bf) + of_others.dot(Gf * of_others);
  }
  return fit;
}

}  // namespace mjdiag
