#include "mjdiag/diagnosis/twin/linear_twin.h"

#include <cmath>
#include <numbers>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Column of that direction, a new one if there is none yet.
Index DirectionOf(LeverArms& arms, const VectorXd& direction) {
  for (Index i = 0; i < arms.directions.cols(); ++i) {
    if (arms.directions.col(i) == direction) return i;
  }
  const Index count = arms.directions.cols();
  arms.directions.conservativeResize(direction.size(), count + 1);
  arms.directions.col(count) = direction;
  return count;
}

/// Row by row: the force on a coordinate is minus what the row says.
void AddRows(LeverArms& arms, Index unknown, const MatrixXd& slope,
             LeverSignal signal) {
  for (Index row = 0; row < slope.rows(); ++row) {
    for (Index i = 0; i < slope.cols(); ++i) {
      if (slope(row, i) == 0.0) continue;
      const Index direction = DirectionOf(arms, VectorXd::Unit(slope.rows(), row));
      arms.levers.push_back({unknown, direction, signal, i, -slope(row, i)});
    }
  }
}

LeverArms ArmsOf(const UncertainModel& model) {
  LeverArms arms;
  arms.directions.resize(model.nominal.M.rows(), 0);
  Index unknown = 0;
  for (const ModelSlope& slope : model.slopes) {
    AddRows(arms, unknown, slope.D, LeverSignal::kVelocity);
    AddRows(arms, unknown, slope.K, LeverSignal::kPosition);
    for (Index i = 0; i < slope.Gamma.cols(); ++i) {
      if (slope.Gamma.col(i).isZero(0.0)) continue;
      const Index direction = DirectionOf(arms, slope.Gamma.col(i));
      arms.levers.push_back({unknown, direction, LeverSignal::kInput, i, 1.0});
    }
    ++unknown;
  }
  for (const UnknownTone& tone : model.tones) {
    const auto index = static_cast<Index>(arms.tones.size());
    // Its own: it changes with the motors.
    const Index direction = arms.directions.cols();
    arms.directions.conservativeResize(Eigen::NoChange, direction + 1);
    arms.directions.col(direction) = model.nominal.Gamma * tone.amplitude;
    arms.levers.push_back({unknown++, direction, LeverSignal::kSine, index, 1.0});
    arms.levers.push_back({unknown++, direction, LeverSignal::kCosine, index, 1.0});
    arms.tones.push_back(tone.frequency);
  }
  return arms;
}

/// K with a slow spring for what nothing holds.
MatrixXd Held(const MechanicalModel& model) {
  constexpr double kSlow = 2.0 * std::numbers::pi * 5.0;  // rad/s
  return model.K + kSlow * kSlow * model.M;
}

}  // namespace

MatrixXd PlacementOf(const MechanicalModel& model) {
  const MatrixXd give = Solve(Held(model), model.b);
  return give * Solve(model.b.transpose() * give,
                      MatrixXd::Identity(model.b.cols(), model.b.cols()));
}

MatrixXd StartDirections(const MechanicalModel& model, double energy) {
  const Index nq = model.M.rows();
  const MatrixXd held = Held(model);
  // With A = L L^T a root of A^-1 is L^-T.
  const auto root = [&](const MatrixXd& A) {
    return MatrixXd(Eigen::LLT<MatrixXd>(0.5 * (A + A.transpose()))
                        .matrixL()
                        .solve(MatrixXd::Identity(nq, nq))
                        .transpose());
  };
  MatrixXd directions = MatrixXd::Zero(2 * nq, 2 * nq);
  directions.topLeftCorner(nq, nq) = std::sqrt(energy) * root(held);
  directions.bottomRightCorner(nq, nq) = std::sqrt(energy) * root(model.M);
  return directions;
}

LinearTwin::LinearTwin(const UncertainModel& model, const MatrixXd& gain, Index block)
    : model_(model),
      L_(gain),
      block_(block),
      arms_(ArmsOf(model)),
      start_directions_(model.start) {
  const MechanicalModel& nominal = model_.nominal;
  const Index nq = nominal.M.rows();
  const Index ny = nominal.b.cols();
  const Index nu = nominal.Gamma.cols();
  const auto p = static_cast<Index>(model_.unknowns.size());
  const Index directions = arms_.directions.cols();
  C_ = MatrixXd::Zero(ny, 2 * nq);
  C_.leftCols(nq) = nominal.b.transpose();
  mean_ = C_ / static_cast<double>(block_);
  place_ = PlacementOf(nominal);
  remembered_ = VectorXd::Zero(2 * nq);
  theta_ = slope_ = VectorXd::Zero(p);
  M_ = nominal.M;
  D_ = left_ = M_;
  K_ = M_;
  Gamma_ = nominal.Gamma;
  factor_ = Eigen::LLT<MatrixXd>(nq);
  A_ = F_ = power_ = scratch_ = MatrixXd::Zero(2 * nq, 2 * nq);
  B_ = MatrixXd::Zero(2 * nq, nu);
  force_ = MatrixXd::Zero(2 * nq, nq);
  carried_.assign(static_cast<std::size_t>(block_), MatrixXd::Zero(2 * nq, directions));
  seen_ = MatrixXd::Zero(ny, 2 * nq);
  seen_of_.assign(static_cast<std::size_t>(block_), MatrixXd::Zero(ny, directions));
  x_ = next_ = VectorXd::Zero(2 * nq);
  u_ = VectorXd::Zero(nu);
  phase_ = VectorXd::Zero(2 * static_cast<Index>(arms_.tones.size()));
  turn_ = phase_;
  for (std::size_t i = 0; i < arms_.tones.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * arms_.tones[i] * model_.timing.step *
                         model_.timing.substeps;
    turn_[2 * static_cast<Index>(i)] = std::sin(angle);
    turn_[2 * static_cast<Index>(i) + 1] = std::cos(angle);
  }
  S_ = S_next_ = S_drive_ = MatrixXd::Zero(2 * nq, p);
  seen_drive_ = sensitivity_ = MatrixXd::Zero(ny, p);
}

double LinearTwin::Value(Index unknown) const {
  return model_.unknowns[static_cast<std::size_t>(unknown)].factor
             ? std::exp(theta_[unknown])
             : theta_[unknown];
}

void LinearTwin::MakeMaps() noexcept {
  const MechanicalModel& nominal = model_.nominal;
  const Index nq = M_.rows();
  D_ = nominal.D;
  K_ = nominal.K;
  Gamma_ = nominal.Gamma;
  for (std::size_t i = 0; i < model_.slopes.size(); ++i) {
    const ModelSlope& slope = model_.slopes[i];
    const auto unknown = static_cast<Index>(i);
    const double moved = Value(unknown) - model_.unknowns[i].nominal;
    if (slope.D.size() > 0) D_ += moved * slope.D;
    if (slope.K.size() > 0) K_ += moved * slope.K;
    if (slope.Gamma.size() > 0) Gamma_ += moved * slope.Gamma;
  }
  for (Index i = 0; i < theta_.size(); ++i) {
    slope_[i] = model_.unknowns[static_cast<std::size_t>(i)].factor ? Value(i) : 1.0;
  }
  // A substep: v' = v + h (M + h D)^-1 (f - K q - D v), q' = q + h v'.
  const double h = model_.timing.step;
  left_ = M_ + h * D_;
  factor_.compute(left_);
  A_.setIdentity();
  force_.setZero();
  auto columns = scratch_.leftCols(nq);  // of work space
  for (int substep = 0; substep < model_.timing.substeps; ++substep) {
    const auto advance = [&](auto& map, bool driven) {
      for (Index first = 0; first < map.cols(); first += nq) {
        auto part = map.middleCols(first, nq);
        auto change = columns.topRows(nq);
        change.noalias() = K_ * part.topRows(nq);
        change.noalias() += D_ * part.bottomRows(nq);
        change *= -1.0;
        if (driven) change += MatrixXd::Identity(nq, nq);
        factor_.solveInPlace(change);
        part.bottomRows(nq) += h * change;
        part.topRows(nq) += h * part.bottomRows(nq);
      }
    };
    advance(A_, false);
    advance(force_, true);
  }
  B_.noalias() = force_ * Gamma_;

  // Of the tones, with the motors as they are.
  for (const Lever& lever : arms_.levers) {
    if (lever.signal != LeverSignal::kSine) continue;
    arms_.directions.col(lever.direction).noalias() =
        Gamma_ * model_.tones[static_cast<std::size_t>(lever.index)].amplitude;
  }
  F_ = A_;
  carried_.back().noalias() = force_ * arms_.directions;
  power_ = F_;
  seen_ = mean_;
  for (Index j = block_ - 2; j >= 0; --j) {
    const auto at = static_cast<std::size_t>(j);
    carried_[at].noalias() = F_ * carried_[at + 1];
  }
  // seen_of_[j] = (1/d) sum_(i>j) C F^(i-1-j) B E: what is carried from the end of j.
  seen_of_.back().setZero();
  for (Index j = block_ - 2; j >= 0; --j) {
    const auto at = static_cast<std::size_t>(j);
    seen_of_[at] = seen_of_[at + 1];
    seen_of_[at].noalias() += mean_ * carried_[at + 1];
  }
  for (Index j = 1; j < block_; ++j) {
    seen_.noalias() += mean_ * power_;
    scratch_.noalias() = F_ * power_;
    power_.swap(scratch_);
  }
}

void LinearTwin::Start(const VectorXd& theta, bool at_rest) noexcept {
  theta_ = theta;
  in_block_ = 0;
  x_.setZero();
  S_.setZero();
  const Index k = start_directions_.cols();
  active_ = theta_.size() - (at_rest ? k : 0);
  if (!at_rest) {
    x_ = remembered_;
    x_.noalias() += start_directions_ * theta_.tail(k);
    S_.rightCols(k) = start_directions_;
  }
  S_drive_.setZero();
  seen_drive_.setZero();
  for (std::size_t i = 0; i < arms_.tones.size(); ++i) {
    phase_[2 * static_cast<Index>(i)] = 0.0;
    phase_[2 * static_cast<Index>(i) + 1] = 1.0;
  }
  MakeMaps();
}

void LinearTwin::Place(const VectorXd& reading) noexcept {
  x_.setZero();
  x_.head(M_.rows()).noalias() = place_ * reading;
  x_.head(M_.rows()).noalias() -= place_ * model_.rest;
}

void LinearTwin::Remember() noexcept { remembered_ = x_; }

void LinearTwin::Predict(VectorXd& reading) noexcept {
  reading = model_.rest;
  reading.noalias() += C_ * x_;
}

void LinearTwin::Step(std::span<const double> inputs,
                      const VectorXd& innovation) noexcept {
  const Index nq = M_.rows();
  u_ = VectorXd::Map(inputs.data(), u_.size());
  const Index first = theta_.size() - start_directions_.cols() - phase_.size();
  for (std::size_t i = 0; i < model_.tones.size(); ++i) {
    const Index at = 2 * static_cast<Index>(i);
    u_ += (theta_[first + at] * phase_[at] + theta_[first + at + 1] * phase_[at + 1]) *
          model_.tones[i].amplitude;
  }
  next_.noalias() = A_ * x_;
  next_.noalias() += B_ * u_;

  // The mean of a tick of n steps, of which each takes the position at its start and
  // the velocity at its end.
  const auto steps = static_cast<double>(model_.timing.substeps);
  const double of_position = 0.5 * (steps - 1.0) / steps;
  const double of_velocity = 0.5 * (steps + 1.0) / steps;
  const auto at = static_cast<std::size_t>(in_block_);
  for (const Lever& lever : arms_.levers) {
    double signal = 0.0;
    switch (lever.signal) {
      case LeverSignal::kVelocity:
        signal = x_[nq + lever.index] +
                 of_velocity * (next_[nq + lever.index] - x_[nq + lever.index]);
        break;
      case LeverSignal::kPosition:
        signal = x_[lever.index] + of_position * (next_[lever.index] - x_[lever.index]);
        break;
      case LeverSignal::kInput:
        signal = u_[lever.index];
        break;
      case LeverSignal::kSine:
        signal = phase_[2 * lever.index];
        break;
      case LeverSignal::kCosine:
        signal = phase_[2 * lever.index + 1];
        break;
    }
    signal *= lever.coefficient * slope_[lever.unknown];
    S_drive_.col(lever.unknown) += signal * carried_[at].col(lever.direction);
    seen_drive_.col(lever.unknown) += signal * seen_of_[at].col(lever.direction);
  }
  next_.noalias() += L_ * innovation;
  x_.swap(next_);
  for (Index i = 0; i < phase_.size(); i += 2) {
    const double sine = phase_[i];
    const double cosine = phase_[i + 1];
    phase_[i] = sine * turn_[i + 1] + cosine * turn_[i];
    phase_[i + 1] = cosine * turn_[i + 1] - sine * turn_[i];
  }
  ++in_block_;
}

const MatrixXd& LinearTwin::EndBlock() noexcept {
  sensitivity_ = seen_drive_;
  sensitivity_.leftCols(active_).noalias() += seen_ * S_.leftCols(active_);
  S_next_ = S_drive_;
  S_next_.leftCols(active_).noalias() += power_ * S_.leftCols(active_);
  S_.swap(S_next_);
  S_drive_.setZero();
  seen_drive_.setZero();
  in_block_ = 0;
  return sensitivity_;
}

void LinearTwin::Shift(const VectorXd& change) noexcept {
  theta_ += change;
  x_.noalias() += S_ * change;
  MakeMaps();
}

}  // namespace mjdiag
