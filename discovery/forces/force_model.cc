#include "mjdiag/discovery/forces/force_model.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNever = std::numeric_limits<double>::infinity();

std::vector<bool> Seen(const ForceRows& rows) {
  std::vector<bool> seen(static_cast<std::size_t>(rows.values()), false);
  std::fill(seen.begin(), seen.begin() + rows.train, true);
  return seen;
}

/// Places of some values of all joints.
std::vector<Index> PlacesOf(const ForceRows& rows, Index first, Index last) {
  std::vector<Index> places;
  for (Index j = 0; j < std::ssize(rows.dofs); ++j) {
    for (Index k = first; k < last; ++k) places.push_back(j * rows.values() + k);
  }
  return places;
}

/// All columns as they were measured, and by how much each scales a drive.
struct Columns {
  MatrixXd measured;  ///< [numbers, columns of all groups]
  VectorXd scales;
};

Columns ColumnsOf(const ForceProblem& problem,
                  const std::vector<const ForceGroup*>& groups) {
  Index count = problem.numbers.cols();
  for (const ForceGroup* group : groups) count += group->columns.cols();
  Columns all{MatrixXd(problem.missing.size(), count), VectorXd::Zero(count)};
  Index next = problem.numbers.cols();
  all.measured.leftCols(next) = problem.numbers;
  all.scales.head(next) = problem.drives;
  for (const ForceGroup* group : groups) {
    const Index size = group->columns.cols();
    all.measured.middleCols(next, size) = group->columns;
    if (group->scales_drive) all.scales.segment(next, size).setOnes();
    next += size;
  }
  return all;
}

/// The model about theta: what it leaves, and what each column takes away of it.
struct About {
  VectorXd left;
  MatrixXd columns;
  VectorXd drive;  ///< g of every joint
};

/// Of one column that scales a drive by so much.
template <typename Column>
void Linearise(const ForceRows& rows, const About& at, double scale, Column column) {
  for (Index j = 0; j < std::ssize(rows.dofs); ++j) {
    auto own = column.segment(j * rows.values(), rows.values());
    if (own.isZero(0.0)) continue;
    if (scale != 0.0) own += scale * at.left.segment(j * rows.values(), rows.values());
    own /= at.drive[j];
  }
}

About ModelAbout(const ForceProblem& problem, const Columns& columns,
                 const VectorXd& theta) {
  constexpr double kLeast = 0.05;
  const ForceRows& rows = problem.rows;
  About at;
  at.drive = VectorXd::Ones(std::ssize(rows.dofs));
  for (Index c = 0; c < theta.size(); ++c) {
    if (columns.scales[c] == 0.0) continue;
    for (Index j = 0; j < at.drive.size(); ++j) {
      const auto own =
          columns.measured.col(c).segment(j * rows.values(), rows.values());
      if (!own.isZero(0.0)) at.drive[j] += columns.scales[c] * theta[c];
    }
  }
  at.drive = at.drive.cwiseMax(kLeast);
  at.left = problem.missing - columns.measured * theta;
  for (Index j = 0; j < at.drive.size(); ++j) {
    at.left.segment(j * rows.values(), rows.values()) /= at.drive[j];
  }
  at.columns = columns.measured;
  for (Index c = 0; c < theta.size(); ++c) {
    Linearise(rows, at, columns.scales[c], at.columns.col(c));
  }
  return at;
}

VectorXd ThetaOf(const ForceFit& fit) {
  VectorXd theta(fit.z.size() + fit.amplitudes.size());
  theta << fit.z, fit.amplitudes;
  return theta;
}

/// Of normal equations with what is known of the numbers beside them.
VectorXd SolveNormal(const MatrixXd& matrix, const VectorXd& right, Index numbers) {
  if (right.size() == 0) return right;  // nothing is unknown
  constexpr double kRidge = 1e-10;
  MatrixXd with = matrix;
  with.diagonal().head(numbers).array() += 1.0;
  const VectorXd scale = with.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  MatrixXd unit = scale.asDiagonal() * with * scale.asDiagonal();
  unit.diagonal().array() += kRidge;
  return scale.cwiseProduct(unit.ldlt().solve(scale.cwiseProduct(right)));
}

bool IsWithin(const std::vector<const ForceGroup*>& groups,
              const VectorXd& amplitudes) {
  Index next = 0;
  for (const ForceGroup* group : groups) {
    const auto own = amplitudes.segment(next, group->columns.cols());
    next += group->columns.cols();
    if (group->least.size() == 0) continue;
    if ((own.array() < group->least.array() - 1e-12 * own.array().abs()).any()) {
      return false;
    }
  }
  return true;
}

/// Predictions of parts from the others.
class Unseen {
 public:
  Unseen(const ForceProblem& problem, const std::vector<const ForceGroup*>& groups,
         const ForceFit& fit)
      : numbers_(problem.numbers.cols()) {
    constexpr Index kParts = 5;
    const VectorXd theta = ThetaOf(fit);
    const About at = ModelAbout(problem, ColumnsOf(problem, groups), theta);
    MatrixXd both(at.columns.rows(), at.columns.cols() + 1);
    both << at.columns, at.left + at.columns * theta;
    const MatrixXd white = Whitened(problem.rows, fit.noise, both);
    sum_ = MatrixXd::Zero(both.cols(), both.cols());
    for (Index part = 0; part < kParts; ++part) {
      parts_.push_back(white(PlacesOf(problem.rows, problem.rows.train * part / kParts,
                                      problem.rows.train * (part + 1) / kParts),
                             Eigen::all));
      matrices_.push_back(parts_.back().transpose() * parts_.back());
      sum_ += matrices_.back();
    }
  }

  Index columns() const { return sum_.cols() - 1; }
  /// With these columns only.
  double Squares(const std::vector<Index>& kept) const {
    double squares = 0.0;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      const MatrixXd others = sum_ - matrices_[part];
      const VectorXd x =
          SolveNormal(others(kept, kept), others(kept, columns()), numbers_);
      squares += (parts_[part].rightCols(1) - parts_[part](Eigen::all, kept) * x)
                     .squaredNorm();
    }
    return squares;
  }

 private:
  Index numbers_;
  std::vector<MatrixXd> parts_;
  std::vector<MatrixXd> matrices_;
  MatrixXd sum_;
};

}  // namespace

ForceNoise NoiseOfNothing(const ForceProblem& problem) {
  return NoiseOf(problem.rows, problem.missing, Seen(problem.rows));
}

namespace {

/// Generalised least squares and the noise of what that leaves, in turn.
ForceFit FitFrom(const ForceProblem& problem,
                 const std::vector<const ForceGroup*>& groups,
                 const ForceNoise& start) {
  constexpr int kIterations = 4;
  const Index numbers = problem.numbers.cols();
  const std::vector<bool> seen = Seen(problem.rows);
  const std::vector<Index> places = PlacesOf(problem.rows, 0, problem.rows.train);
  ForceFit fit;
  fit.noise = start;
  const Columns columns = ColumnsOf(problem, groups);
  VectorXd theta = VectorXd::Zero(columns.scales.size());
  About at = ModelAbout(problem, columns, theta);
  for (int i = 0; i < kIterations; ++i) {
    MatrixXd both(at.columns.rows(), at.columns.cols() + 1);
    both << at.columns, at.left + at.columns * theta;
    const MatrixXd white = Whitened(problem.rows, fit.noise, both)(places, Eigen::all);
    const auto A = white.leftCols(theta.size());
    theta = SolveNormal(A.transpose() * A, A.transpose() * white.rightCols(1), numbers);
    at = ModelAbout(problem, columns, theta);
    fit.left = at.left;
    fit.noise = NoiseOf(problem.rows, fit.left, seen);
  }
  fit.z = theta.head(numbers);
  fit.amplitudes = theta.tail(theta.size() - numbers);
  const double n = std::max(2.0, static_cast<double>(problem.rows.train));
  fit.score = DevianceOf(problem.rows, fit.noise, seen) + fit.z.squaredNorm() +
              static_cast<double>(fit.amplitudes.size()) * std::log(n);
  for (const ForceGroup* group : groups) fit.score += group->cost;
  if (!theta.allFinite() || !IsWithin(groups, fit.amplitudes)) fit.score = kNever;
  return fit;
}

}  // namespace

// What lasts is the noise's or a law's, and either makes the other needless: the two ends
// of that are begun from both.
ForceFit FitForces(const ForceProblem& problem,
                   const std::vector<const ForceGroup*>& groups,
                   const ForceNoise& start) {
  ForceFit lasting = FitFrom(problem, groups, start);
  ForceFit white = FitFrom(problem, groups, WithoutMemory(start));
  return white.score < lasting.score ? white : lasting;
}

MatrixXd NumbersBeside(const ForceProblem& problem,
                       const std::vector<const ForceGroup*>& groups,
                       const ForceFit& fit) {
  return ModelAbout(problem, ColumnsOf(problem, groups), ThetaOf(fit))
      .columns.leftCols(problem.numbers.cols());
}

UnseenLoss LossUnseen(const ForceProblem& problem,
                      const std::vector<const ForceGroup*>& groups,
                      const ForceFit& fit) {
  const Unseen unseen(problem, groups, fit);
  std::vector<Index> all(static_cast<std::size_t>(unseen.columns()));
  std::iota(all.begin(), all.end(), 0);
  const double with = unseen.Squares(all);
  UnseenLoss loss{VectorXd(std::ssize(groups))};
  Index next = problem.numbers.cols();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Index size = groups[g]->columns.cols();
    std::vector<Index> kept = all;
    kept.erase(kept.begin() + next, kept.begin() + next + size);
    next += size;
    loss.each[static_cast<Index>(g)] = unseen.Squares(kept) - with;
  }
  const std::vector<Index> numbers(all.begin(), all.begin() + problem.numbers.cols());
  loss.all = unseen.Squares(numbers) - with;
  return loss;
}

VectorXd GainsBeside(const ForceProblem& problem,
                     const std::vector<const ForceGroup*>& set, const ForceFit& fit,
                     const std::vector<const ForceGroup*>& tried) {
  constexpr double kOwn = 1e-6;  // of a column, squared: no more than the others do
  const Index numbers = problem.numbers.cols();
  const std::vector<Index> places = PlacesOf(problem.rows, 0, problem.rows.train);
  const auto rows = std::ssize(places);
  const double n = std::max(2.0, static_cast<double>(problem.rows.train));
  MatrixXd own = MatrixXd::Zero(rows + numbers, 0);
  const About at = ModelAbout(problem, ColumnsOf(problem, set), ThetaOf(fit));
  own.resize(rows + numbers, at.columns.cols());
  own.topRows(rows) = Whitened(problem.rows, fit.noise, at.columns)(places, Eigen::all);
  own.bottomRows(numbers).setZero();
  own.bottomLeftCorner(numbers, numbers).setIdentity();
  const VectorXd scale = own.colwise().norm().cwiseMax(1e-300);
  own *= scale.cwiseInverse().asDiagonal();
  const MatrixXd Q = own.cols() > 0 ? OrthonormalColumns(own) : MatrixXd(rows, 0);
  VectorXd left(rows + numbers);
  left.head(rows) = Whitened(problem.rows, fit.noise, fit.left)(places, 0);
  left.tail(numbers) = -fit.z;
  VectorXd gains(std::ssize(tried));
  ParallelFor(static_cast<int>(tried.size()), [&](int number) {
    const ForceGroup& group = *tried[static_cast<std::size_t>(number)];
    MatrixXd C = MatrixXd::Zero(rows + numbers, group.columns.cols());
    MatrixXd here = group.columns;
    for (Index c = 0; c < here.cols(); ++c) {
      Linearise(problem.rows, at, group.scales_drive ? 1.0 : 0.0, here.col(c));
    }
    C.topRows(rows) = Whitened(problem.rows, fit.noise, here)(places, Eigen::all);
    const VectorXd size = C.colwise().squaredNorm();
    if (Q.cols() > 0) C -= Q * (Q.transpose() * C);
    double& gain = gains[number];
    gain = -kNever;
    if ((C.colwise().squaredNorm().transpose().array() < kOwn * size.array() + 1e-12)
            .any()) {
      return;
    }
    const VectorXd b = C.transpose() * left;
    const VectorXd a = SolveNormal(C.transpose() * C, b, 0);
    if (!a.allFinite() || !IsWithin({&group}, a)) return;
    gain = b.dot(a) - static_cast<double>(a.size()) * std::log(n) - group.cost;
  });
  return gains;
}

}  // namespace mjdiag
