#include "mjdiag/diagnosis/twin/linear_twin.h"

#include <cmath>
#include <numbers>
#include <utility>

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
void AddRows(LeverArms& arms, const Lever& lever, const MatrixXd& part) {
  for (Index row = 0; row < part.rows(); ++row) {
    for (Index i = 0; i < part.cols(); ++i) {
      if (part(row, i) == 0.0) continue;
      Lever of_entry = lever;
      of_entry.direction = DirectionOf(arms, VectorXd::Unit(part.rows(), row));
      of_entry.index = i;
      of_entry.coefficient = -part(row, i);
      arms.levers.push_back(std::move(of_entry));
    }
  }
}

LeverArms ArmsOf(const UncertainModel& model, Index first_tone) {
  LeverArms arms;
  arms.directions.resize(model.nominal.M.rows(), 0);
  for (std::size_t number = 0; number < model.parts.size(); ++number) {
    const ModelPart& part = model.parts[number];
    Lever lever;
    lever.unknowns = part.factors;
    lever.number = static_cast<Index>(number);
    const auto add = [&](LeverSignal signal, const MatrixXd& rows) {
      lever.signal = signal;
      AddRows(arms, lever, rows);
    };
    add(LeverSignal::kAcceleration, part.M);
    add(LeverSignal::kVelocity, part.D);
    add(LeverSignal::kPosition, part.K);
    add(LeverSignal::kConstant, -part.force);
    lever.signal = LeverSignal::kInput;
    lever.coefficient = 1.0;
    for (Index i = 0; i < part.Gamma.cols(); ++i) {
      if (part.Gamma.col(i).isZero(0.0)) continue;
      lever.direction = DirectionOf(arms, part.Gamma.col(i));
      lever.index = i;
      arms.levers.push_back(lever);
    }
  }
  for (std::size_t i = 0; i < model.tones.size(); ++i) {
    // A direction of its own: it changes with the motors.
    Lever lever;
    lever.direction = arms.directions.cols();
    arms.directions.conservativeResize(Eigen::NoChange, lever.direction + 1);
    arms.directions.col(lever.direction) =
        model.nominal.Gamma * model.tones[i].amplitude;
    lever.index = static_cast<Index>(i);
    lever.coefficient = 1.0;
    for (const LeverSignal signal : {LeverSignal::kSine, LeverSignal::kCosine}) {
      lever.signal = signal;
      lever.unknowns = {first_tone++};
      arms.levers.push_back(lever);
    }
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

LinearTwin::LinearTwin(const UncertainModel& model, std::vector<TwinGain> gains,
                       Index block)
    : Twin({model.nominal.b.cols(), model.nominal.Gamma.cols(),
            2 * model.nominal.M.rows(), static_cast<Index>(model.unknowns.size()),
            model.start.cols(), block},
           std::move(gains), model.tones, model.timing.tick()),
      model_(model) {
  const MechanicalModel& nominal = model_.nominal;
  const Index nq = nominal.M.rows();
  const Index ny = nominal.b.cols();
  const Index nu = nominal.Gamma.cols();
  const auto p = static_cast<Index>(model_.unknowns.size());
  arms_ = ArmsOf(model_, first_tone());
  const Index directions = arms_.directions.cols();
  C_ = MatrixXd::Zero(ny, 2 * nq);
  C_.leftCols(nq) = nominal.b.transpose();
  mean_ = C_ / static_cast<double>(block);
  place_ = PlacementOf(nominal);
  values_ = VectorXd::Ones(static_cast<Index>(model_.parts.size()));
  M_ = D_ = K_ = left_ = nominal.M;
  Gamma_ = nominal.Gamma;
  f_ = VectorXd::Zero(nq);
  factor_ = Eigen::LLT<MatrixXd>(nq);
  A_ = F_ = power_ = scratch_ = MatrixXd::Zero(2 * nq, 2 * nq);
  B_ = MatrixXd::Zero(2 * nq, nu);
  force_ = MatrixXd::Zero(2 * nq, nq);
  carried_.assign(static_cast<std::size_t>(block),
                  MatrixXd::Zero(2 * nq, directions));
  seen_ = MatrixXd::Zero(ny, 2 * nq);
  seen_of_.assign(static_cast<std::size_t>(block), MatrixXd::Zero(ny, directions));
  x_ = next_ = constant_ = VectorXd::Zero(2 * nq);
  S_ = S_next_ = S_drive_ = MatrixXd::Zero(2 * nq, p);
  seen_drive_ = sensitivity_ = MatrixXd::Zero(ny, p);
}

void LinearTwin::MakeMaps() noexcept {
  const MechanicalModel& nominal = model_.nominal;
  const Index nq = M_.rows();
  M_ = nominal.M;
  D_ = nominal.D;
  K_ = nominal.K;
  Gamma_ = nominal.Gamma;
  f_.setZero();
  for (std::size_t i = 0; i < model_.parts.size(); ++i) {
    const ModelPart& part = model_.parts[i];
    const double sum = Logarithm(part.factors);
    values_[static_cast<Index>(i)] = std::exp(sum);
    const double moved = std::expm1(sum);
    if (part.M.size() > 0) M_ += moved * part.M;
    if (part.D.size() > 0) D_ += moved * part.D;
    if (part.K.size() > 0) K_ += moved * part.K;
    if (part.Gamma.size() > 0) Gamma_ += moved * part.Gamma;
    if (part.force.size() > 0) f_ += moved * part.force;
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
  constant_.noalias() = force_ * f_;
  for (const Lever& lever : arms_.levers) {
    if (lever.signal != LeverSignal::kSine) continue;
    arms_.directions.col(lever.direction).noalias() =
        Gamma_ * tones_.amplitude(lever.index);
  }
  LiftSensitivities();
}

void LinearTwin::UseGain(std::size_t gain) noexcept {
  if (gain == gain_) return;
  gain_ = gain;
  LiftSensitivities();
}

void LinearTwin::LiftSensitivities() noexcept {
  F_ = A_;
  F_.noalias() -= gain().L * C_;
  carried_.back().noalias() = force_ * arms_.directions;
  power_ = F_;
  seen_ = mean_;
  for (Index j = block() - 2; j >= 0; --j) {
    const auto at = static_cast<std::size_t>(j);
    carried_[at].noalias() = F_ * carried_[at + 1];
  }
  // seen_of_[j] = (1/d) sum_(i>j) C F^(i-1-j) B E: what is carried from the end of j.
  seen_of_.back().setZero();
  for (Index j = block() - 2; j >= 0; --j) {
    const auto at = static_cast<std::size_t>(j);
    seen_of_[at] = seen_of_[at + 1];
    seen_of_[at].noalias() += mean_ * carried_[at + 1];
  }
  for (Index j = 1; j < block(); ++j) {
    seen_.noalias() += mean_ * power_;
    scratch_.noalias() = F_ * power_;
    power_.swap(scratch_);
  }
}

void LinearTwin::Start(const VectorXd& theta) noexcept {
  Begin(theta, true);
  Reset();
}

void LinearTwin::Start(const VectorXd& theta, const VectorXd& state) noexcept {
  Begin(theta, false);
  Reset();
  x_ = state;
  x_.noalias() += model_.start * theta_.tail(start_unknowns());
  S_.rightCols(start_unknowns()) = model_.start;
}

void LinearTwin::Reset() noexcept {
  in_block_ = 0;
  x_.setZero();
  S_.setZero();
  S_drive_.setZero();
  seen_drive_.setZero();
  MakeMaps();
}

void LinearTwin::StateAt(const VectorXd& reading, VectorXd& state) noexcept {
  state.setZero();
  state.head(M_.rows()).noalias() = place_ * reading;
  state.head(M_.rows()).noalias() -= place_ * model_.rest;
}

void LinearTwin::Predict(VectorXd& reading) noexcept {
  reading = model_.rest;
  reading.noalias() += C_ * x_;
}

double LinearTwin::Signal(const Lever& lever) const noexcept {
  // The mean of a tick of n steps, of which each takes the position at its start and
  // the velocity at its end.
  const Index nq = M_.rows();
  const auto steps = static_cast<double>(model_.timing.substeps);
  const Index i = lever.index;
  switch (lever.signal) {
    case LeverSignal::kAcceleration:
      return (next_[nq + i] - x_[nq + i]) / model_.timing.tick();
    case LeverSignal::kVelocity:
      return x_[nq + i] + 0.5 * (steps + 1.0) / steps * (next_[nq + i] - x_[nq + i]);
    case LeverSignal::kPosition:
      return x_[i] + 0.5 * (steps - 1.0) / steps * (next_[i] - x_[i]);
    case LeverSignal::kConstant:
      return 1.0;
    case LeverSignal::kInput:
      return u_[i];
    case LeverSignal::kSine:
      return tones_.sine(i);
    case LeverSignal::kCosine:
      return tones_.cosine(i);
  }
  return 0.0;
}

void LinearTwin::Step(std::span<const double> inputs,
                      const VectorXd& innovation) noexcept {
  Command(inputs);
  next_ = constant_;
  next_.noalias() += A_ * x_;
  next_.noalias() += B_ * u_;
  const auto at = static_cast<std::size_t>(in_block_);
  for (const Lever& lever : arms_.levers) {
    const double value = lever.number < 0 ? 1.0 : values_[lever.number];
    const double force = value * lever.coefficient * Signal(lever);
    for (const Index unknown : lever.unknowns) {
      S_drive_.col(unknown) += force * carried_[at].col(lever.direction);
      seen_drive_.col(unknown) += force * seen_of_[at].col(lever.direction);
    }
  }
  next_.noalias() += gain().L * innovation;
  x_.swap(next_);
  tones_.Advance();
  ++in_block_;
}

const MatrixXd& LinearTwin::EndBlock() noexcept {
  sensitivity_ = seen_drive_;
  sensitivity_.leftCols(acting()).noalias() += seen_ * S_.leftCols(acting());
  S_next_ = S_drive_;
  S_next_.leftCols(acting()).noalias() += power_ * S_.leftCols(acting());
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
