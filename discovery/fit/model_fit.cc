#include "mjdiag/discovery/fit/model_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/discovery/regression/whitening.h"
#include "mjdiag/plugin/replay/bounded_descent.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Residuals at x.
class Innovations {
 public:
  Innovations(const MachineWith& machine_with, const MeasuredRun& run,
              const FilterPath& path, const KeptGains& gains, Model model,
              std::vector<Coordinate> coordinates)
      : machine_with_(machine_with),
        run_(run),
        path_(path),
        gains_(gains),
        model_(std::move(model)),
        coordinates_(std::move(coordinates)) {}

  Index rows() const { return gains_.rows(); }
  Index size() const { return std::ssize(coordinates_); }
  const std::vector<Coordinate>& coordinates() const { return coordinates_; }

  const VectorXd& Of(const VectorXd& x) {
    if (kept_.size() > 0 && x == at_) return kept_;
    kept_ = RunAt(x);
    at_ = x;
    return kept_;
  }

  /// Where it was taken last, unless it has been dropped: it takes as many runs as there are
  /// coordinates but for those of what pushes, which is known where the machine is.
  const MatrixXd& Jacobian(const VectorXd& x) {
    if (J_.size() > 0) return J_;
    const Machine here = machine_with_(At(coordinates_, model_, x));
    std::vector<Machine> pushing;
    std::vector<Index> by_pushes, by_runs;
    VectorXd steps(size());
    for (Index i = 0; i < size(); ++i) {
      const Coordinate& one = coordinates_[static_cast<std::size_t>(i)];
      steps[i] = one.is_log ? 1e-4 : std::max(1e-3 * std::abs(x[i]), 1e-6);
      if (x[i] + steps[i] > one.upper) steps[i] = -steps[i];
      Machine moved = machine_with_(At(coordinates_, model_, Moved(x, i, steps[i])));
      const bool pushes = here.DiffersInPushes(moved);
      (pushes ? by_pushes : by_runs).push_back(i);
      if (pushes) pushing.push_back(std::move(moved));
    }
    MatrixXd J(rows(), size());
    if (!pushing.empty()) {
      J(Eigen::indexing::all, by_pushes) =
          ByPushes(here, pushing) * steps(by_pushes).cwiseInverse().asDiagonal();
    }
    const VectorXd base = Of(x);
    ParallelForAll(static_cast<int>(by_runs.size()), [&](int number) {
      const Index i = by_runs[static_cast<std::size_t>(number)];
      J.col(i) = (RunAt(Moved(x, i, steps[i])) - base) / steps[i];
    });
    J_ = std::move(J);
    J_at_ = x;
    return J_;
  }
  bool HasJacobianOf(const VectorXd& x) const { return J_.size() > 0 && J_at_ == x; }
  void DropJacobian() { J_.resize(0, 0); }

 private:
  static VectorXd Moved(VectorXd x, Index place, double step) {
    x[place] += step;
    return x;
  }

  /// What they leave more than the machine, to first order.
  MatrixXd ByPushes(const Machine& machine, const std::vector<Machine>& pushing) const {
    const std::vector<MatrixXd> pushes =
        PushesAlong(machine, run_, path_, gains_, pushing);
    std::vector<Column> columns(pushes.size());
    std::vector<const Column*> all;
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      for (Index dof = 0; dof < pushes[i].rows(); ++dof) {
        if (pushes[i].row(dof).isZero(0.0)) continue;
        columns[i].forces.emplace_back(dof, pushes[i].row(dof).transpose());
      }
      all.push_back(&columns[i]);
    }
    return -WhitenedAlong(path_, gains_, all);
  }

  VectorXd RunAt(const VectorXd& x) const {
    return PredictAlong(machine_with_(At(coordinates_, model_, x)), run_, path_,
                        gains_);
  }

  const MachineWith& machine_with_;
  const MeasuredRun& run_;
  const FilterPath& path_;
  const KeptGains& gains_;
  Model model_;
  std::vector<Coordinate> coordinates_;
  VectorXd at_, kept_;
  MatrixXd J_;
  VectorXd J_at_;
};

/// What is known beforehand of coordinates, SizePrice(w^T x) of the rows w of R: as a sum of
/// squares near x.
struct KnownNear {
  double price = 0.0;
  VectorXd slope;  // half of it
  MatrixXd bend;   // the same
};

KnownNear KnownAt(const std::vector<Coordinate>& coordinates, const MatrixXd& R,
                  const VectorXd& x) {
  KnownNear known{0.0, VectorXd::Zero(x.size()), MatrixXd::Zero(x.size(), x.size())};
  for (Index i = 0; i < x.size(); ++i) {
    if (!coordinates[static_cast<std::size_t>(i)].is_known) continue;
    const VectorXd w = R.row(i).transpose();
    const double u = w.dot(x);
    const double weight = 1.0 / (1.0 + u * u / 3.0);
    known.price += SizePrice(u);
    known.slope += weight * u * w;
    known.bend += weight * w * w.transpose();
  }
  return known;
}

/// |r(x)|^2 with what is known beforehand, made least by steps of Gauss and Newton within the
/// bounds of the coordinates, shorter ones [Levenberg, Marquardt] where nothing is gained.
class Fitting {
 public:
  /// @param from  where it begins, and what is not fitted stays
  Fitting(Innovations& innovations, const MatrixXd& R, const VectorXd& from,
          FittedValues fitted)
      : innovations_(innovations),
        R_(R),
        lower_(innovations.size()),
        upper_(innovations.size()) {
    for (Index i = 0; i < innovations.size(); ++i) {
      const Coordinate& one = innovations.coordinates()[static_cast<std::size_t>(i)];
      const bool stays = fitted == FittedValues::kSizes && !one.is_known;
      lower_[i] = stays ? from[i] : one.lower;
      upper_[i] = stays ? from[i] : one.upper;
    }
  }

  VectorXd From(VectorXd x, const FitEffort& effort) {
    // A step takes one run, slopes as many as there are coordinates: these hold as long as steps
    // gain what they say.
    constexpr int kTries = 3;
    constexpr double kTold = 0.5;  // of what was hoped, more or less
    x = x.cwiseMax(lower_).cwiseMin(upper_);
    double here = CostAt(x);
    Near near = NearTo(x);
    double damping = 0.0;
    int taken = 0;
    int steps = 0;
    for (int i = 0; i < kTries * effort.iterations; ++i) {
      MatrixXd damped = near.bend;
      damped.diagonal() *= 1.0 + damping;
      const VectorXd s = LeastWithin(damped, near.slope, lower_ - x, upper_ - x);
      const double along = 2.0 * near.slope.dot(s);
      const double hoped = -along - s.dot(near.bend * s);
      if (!(hoped > effort.end)) break;
      const double there = CostOf(x + s);
      if (there < here) {
        if (std::abs(here - there - hoped) > kTold * hoped) {
          innovations_.DropJacobian();
          ++taken;
        }
        x += s;
        here = there;
        damping *= 0.1;
        const bool is_hopeless = ++steps >= kTries && here > effort.hopeless;
        if (is_hopeless || taken == effort.iterations) break;
        near = NearTo(x);
        continue;
      }
      if (!innovations_.HasJacobianOf(x)) {
        innovations_.DropJacobian();
        near = NearTo(x);
        continue;
      }
      damping = (1.0 + damping) / ShorterBy(along, there - here) - 1.0;
    }
    return x;
  }

 private:
  /// The parabola near a point: half of its slope and of how it bends.
  struct Near {
    VectorXd slope;
    MatrixXd bend;
  };

  Near NearTo(const VectorXd& x) {
    const MatrixXd& J = innovations_.Jacobian(x);
    const KnownNear known = KnownAt(innovations_.coordinates(), R_, x);
    Near near{J.transpose() * innovations_.Of(x) + known.slope,
              J.transpose() * J + known.bend};
    if (!near.bend.allFinite()) {
      throw NumericalError("fit: the run with the first values diverges");
    }
    // What nothing tells stays where it is.
    near.bend.diagonal().array() += 1e-9 * near.bend.diagonal().maxCoeff();
    return near;
  }

  double CostAt(const VectorXd& x) {
    return innovations_.Of(x).squaredNorm() +
           KnownAt(innovations_.coordinates(), R_, x).price;
  }
  /// Infinite where a step is too long.
  double CostOf(const VectorXd& x) {
    try {
      return CostAt(x);
    } catch (const NumericalError&) {  // diverges
    } catch (const InputError&) {      // takes away more than there is
    }
    return std::numeric_limits<double>::infinity();
  }

  Innovations& innovations_;
  const MatrixXd& R_;
  VectorXd lower_, upper_;
};

}  // namespace

MachineWith InTime(MachineWith machine_with, std::function<bool()> is_over) {
  return [machine_with = std::move(machine_with),
          is_over = std::move(is_over)](const Model& model) {
    if (is_over()) throw NumericalError("fit: asked to end");
    return machine_with(model);
  };
}

ModelFit FitModel(const MachineWith& machine_with, const MeasuredRun& run,
                  const FilterPath& path, const KeptGains& gains,
                  const std::vector<Block>& blocks, const Model& start,
                  FitEffort effort, FittedValues fitted) {
  const std::vector<Coordinate> coordinates = CoordinatesOf(blocks, start);
  const MatrixXd R = WhiteningOf(blocks, start, coordinates);
  Innovations innovations(machine_with, run, path, gains, start, coordinates);
  VectorXd x = Place(coordinates, start);
  innovations.Of(x);
  if (x.size() > 0 && effort.iterations > 0) {
    x = Fitting(innovations, R, x, fitted).From(x, effort);
  }
  ModelFit fit;
  fit.model = At(coordinates, start, x);
  fit.deviance = innovations.Of(x).squaredNorm() + gains.log_determinant;
  for (const Member& member : fit.model) {
    fit.prior +=
        blocks[member.block].price + SizePrice(blocks[member.block], member.values);
  }
  if (x.size() > 0) {
    const MatrixXd& J = innovations.Jacobian(x);
    const Eigen::LLT<MatrixXd> solved(J.transpose() * J + R.transpose() * R);
    fit.occam = 2.0 * (solved.matrixLLT().diagonal().array().log().sum() -
                       R.diagonal().array().log().sum());
    fit.sd =
        solved.solve(MatrixXd::Identity(x.size(), x.size())).diagonal().cwiseSqrt();
  }
  return fit;
}

}  // namespace mjdiag
