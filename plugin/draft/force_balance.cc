#include "mjdiag/plugin/draft/force_balance.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/draft/plant_places.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/derivative.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/zero_phase.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewest = 64;        // samples
constexpr Index kMost = 1500;        // instants at which forces are evaluated
constexpr int kOrder = 3;            // of the low-pass
constexpr double kEnds = 0.05;       // of the record, where filters begin
constexpr double kRounding = 1e-18;  // of squares of terms that do not change
constexpr double kTurning =
    0.1;  // of the usual speed: dry friction turns round below it

/// nv x instants each.
struct Terms {
  MatrixXd speed;
  MatrixXd inertia;
  MatrixXd rest;      ///< gravity, springs, dampers, constraints
  MatrixXd supplied;  ///< by actuators
};

MatrixXd LowPassed(const MatrixXd& rows, const SecondOrderSections& filter) {
  MatrixXd filtered(rows.rows(), rows.cols());
  for (Index i = 0; i < rows.rows(); ++i) {
    filtered.row(i) = FilterZeroPhase(filter, rows.row(i).transpose()).transpose();
  }
  return filtered;
}

MatrixXd Derivative(const MatrixXd& rows, double sample_time) {
  MatrixXd rates(rows.rows(), rows.cols());
  for (Index i = 0; i < rows.rows(); ++i) {
    rates.row(i) = CentralDifference(rows.row(i).transpose(), sample_time).transpose();
  }
  return rates;
}

MatrixXd Later(const MatrixXd& rows, int lag) {
  MatrixXd later(rows.rows(), rows.cols());
  for (Index k = 0; k < rows.cols(); ++k) {
    later.col(k) = rows.col(std::clamp<Index>(k - lag, 0, rows.cols() - 1));
  }
  return later;
}

/// @param motion  low-passed
Terms EvaluateTerms(const mjModel& model, mjData& data, const LoggedMotion& motion) {
  const MatrixXd& position = motion.positions;
  const double sample_time = motion.sample_time;
  const MatrixXd speed = Derivative(position, sample_time);
  const MatrixXd acceleration = Derivative(speed, sample_time);
  const auto samples = static_cast<double>(position.cols());
  const auto first = static_cast<Index>(kEnds * samples);
  const Index span = position.cols() - 2 * first;
  const Index stride = std::max<Index>(1, span / kMost);
  const Index count = span / stride;
  const Index nv = model.nv;
  Terms terms{MatrixXd(nv, count), MatrixXd(nv, count), MatrixXd(nv, count),
              MatrixXd(nv, count)};
  VectorXd inertia(nv);
  for (Index i = 0; i < count; ++i) {
    const Index k = first + i * stride;
    mju_copy(data.qpos, position.col(k).data(), model.nq);
    mju_copy(data.qvel, speed.col(k).data(), model.nv);
    mju_copy(data.qacc, acceleration.col(k).data(), model.nv);
    if (model.nu > 0) mju_copy(data.ctrl, motion.controls.col(k).data(), model.nu);
    mj_inverse(&model, &data);
    mj_fwdActuation(&model, &data);
    mj_mulM(&model, &data, inertia.data(), data.qacc);
    terms.speed.col(i) = speed.col(k);
    terms.inertia.col(i) = inertia;
    terms.rest.col(i) = VectorXd::Map(data.qfrc_inverse, nv) - inertia;
    terms.supplied.col(i) =
        VectorXd::Map(data.qfrc_actuator, nv) + motion.forces.col(k);
  }
  return terms;
}

/// What is left of a term when offset, viscous and dry friction are taken out.
class FrictionOut {
 public:
  explicit FrictionOut(const VectorXd& speed) {
    MatrixXd regressors(speed.size(), 3);
    const double turning =
        kTurning * std::sqrt(speed.squaredNorm() / static_cast<double>(speed.size()));
    regressors.col(0).setOnes();
    regressors.col(1) = speed;
    regressors.col(2) = (speed / std::max(turning, 1e-300)).array().tanh();
    basis_ = OrthonormalRange(regressors);
  }
  double SquaredRest(const VectorXd& term) const {
    return (term - basis_ * (basis_.transpose() * term)).squaredNorm();
  }

 private:
  MatrixXd basis_;
};

std::optional<double> ImbalanceOf(const Terms& terms) {
  double left = 0.0;
  int joints = 0;
  for (Index j = 0; j < terms.speed.rows(); ++j) {
    const FrictionOut out(terms.speed.row(j).transpose());
    const VectorXd inertia = terms.inertia.row(j).transpose();
    const VectorXd rest = terms.rest.row(j).transpose();
    const VectorXd supplied = terms.supplied.row(j).transpose();
    const double all =
        out.SquaredRest(inertia) + out.SquaredRest(rest) + out.SquaredRest(supplied);
    const double whole =
        inertia.squaredNorm() + rest.squaredNorm() + supplied.squaredNorm();
    if (!(all > kRounding * whole) || !std::isfinite(all)) continue;
    left += out.SquaredRest(inertia + rest - supplied) / all;
    ++joints;
  }
  if (joints == 0) return std::nullopt;
  return std::sqrt(left / joints);
}

}  // namespace

bool HasForceBalance(const mjModel& model) {
  if (model.na > 0 || model.nv == 0) return false;
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (!IsScalar(model, joint)) return false;
  }
  return true;
}

std::optional<double> ForceImbalance(const mjModel& model, const LoggedMotion& motion,
                                     int lag) {
  if (motion.positions.cols() < kFewest) return std::nullopt;
  const DataPtr data = MakeData(model);
  const MatrixXd controls = Later(motion.controls, lag);
  const MatrixXd forces = Later(motion.forces, lag);
  std::optional<double> least;
  // Octaves below a quarter of the rate.
  for (double share = 0.25; share > 0.005; share /= 2.0) {
    const SecondOrderSections filter =
        DigitalButterworth(FilterKind::kLowPass, kOrder,
                           share / motion.sample_time / 2.0, motion.sample_time);
    try {
      const std::optional<double> imbalance = ImbalanceOf(
          EvaluateTerms(model, *data,
                        {motion.sample_time, LowPassed(motion.positions, filter),
                         LowPassed(controls, filter), LowPassed(forces, filter)}));
      if (imbalance && (!least || *imbalance < *least)) least = imbalance;
    } catch (const NumericalError&) {
      // Columns that are taken for what they are not may be out of all bounds.
    }
  }
  return least;
}

}  // namespace mjdiag
