#include "mjdiag/diagnosis/twin/linear_twin.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Periods in which a resonance rings.
constexpr double kCurvature = 3.0;

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
            model.start.cols(), block, kCurvature},
           std::move(gains), model.tones, model.timing.tick(),
           DriftingOf(model.unknowns)),
      model_(model),
      moved_rest_(model.nominal, model.parts, unknowns()),
      factor_(model.nominal.M.rows()) {
  const MechanicalModel& nominal = model_.nominal;
  const Index nq = nominal.M.rows();
  const Index ny = nominal.b.cols();
  const Index nu = nominal.Gamma.cols();
  const auto p = static_cast<Index>(model_.unknowns.size());
  C_ = MatrixXd::Zero(ny, 2 * nq);
  C_.leftCols(nq) = nominal.b.transpose();
  place_ = PlacementOf(nominal);
  values_ = VectorXd::Ones(static_cast<Index>(model_.parts.size()));
  M_ = D_ = K_ = left_side_ = nominal.M;
  Gamma_ = nominal.Gamma;
  f_ = VectorXd::Zero(nq);
  A_step_ = F_ = power_ = base_ = scratch_ = MatrixXd::Zero(2 * nq, 2 * nq);
  B_step_ = MatrixXd::Zero(2 * nq, nu);
  pulse_step_ = pulse_ = MatrixXd::Zero(2 * nq, nq);
  pulses_.assign(static_cast<std::size_t>(model_.timing.substeps), pulse_);
  before_ = after_ = MatrixXd::Zero(2 * nq, 2 * nq + nu + 1);
  x_ = constant_ = VectorXd::Zero(2 * nq);
  AddSources();
  S_ = S_next_ = MatrixXd::Zero(2 * nq, p);
  sensitivity_ = MatrixXd::Zero(seen(), p);
  S_rate_next_ = S_rate_;
  MakeMaps();
}

void LinearTwin::AddSources() {
  const Index nx = states();
  const auto numbers = static_cast<Index>(model_.parts.size());
  const Index columns = numbers + 2 * tones_.count();
  for (Index i = 0; i < numbers; ++i) {
    const ModelPart& part = model_.parts[static_cast<std::size_t>(i)];
    AddEntries(i, Motion::kAcceleration, part.M);
    AddEntries(i, Motion::kVelocity, part.D);
    AddEntries(i, Motion::kPosition, part.K);
    for (Index input = 0; input < part.Gamma.cols(); ++input) {
      if (part.Gamma.col(input).isZero(0.0)) continue;
      held_.push_back({i, part.Gamma.col(input), input});
    }
    if (part.force.size() > 0) held_.push_back({i, part.force, kNoInput});
  }
  for (Index i = 0; i < tones_.count(); ++i) {
    tone_held_.push_back({numbers + 2 * i, VectorXd::Zero(nx / 2), kNoInput});
  }
  const auto place = [](const Entry& entry) {
    return std::pair(entry.number, entry.on);
  };
  std::ranges::stable_sort(entries_, {}, place);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (i == 0 || place(entries_[i]) != place(entries_[i - 1]))
      moving_.push_back({i, i});
    moving_.back().end = i + 1;
  }
  const auto forces = static_cast<Index>(moving_.size() * pulses_.size());
  tick_ = MatrixXd::Zero(WideRows(nx + forces), before_.cols());
  start_ = VectorXd::Ones(before_.cols());
  end_ = VectorXd::Zero(tick_.rows());
  sources_ =
      MatrixXd::Zero(nx, forces + static_cast<Index>(held_.size() + tone_held_.size()));
  const Index rows = WideRows(seen() + nx);
  left_.assign(static_cast<std::size_t>(block()),
               MatrixXd::Zero(rows, sources_.cols()));
  carry_ = MatrixXd::Zero(rows, nx);
  carried_ = VectorXd::Zero(rows);
  block_ = MatrixXd::Zero(rows, columns);
  AddTerms();
}

void LinearTwin::AddTerms() {
  Index source = 0;
  Index weight = 0;
  for (std::size_t s = 0; s < pulses_.size(); ++s) {
    for (const Moving& moving : moving_) {
      terms_.push_back({weight++, source++, entries_[moving.first].number});
    }
  }
  for (const Held& held : held_) terms_.push_back({weight++, source++, held.column});
  for (const Held& tone : tone_held_) {
    terms_.push_back({weight++, source, tone.column});
    terms_.push_back({weight++, source++, tone.column + 1});
  }
  weights_ = VectorXd::Zero(weight);
  std::ranges::stable_sort(terms_, {}, &WideTerm::into);
}

void LinearTwin::AddEntries(Index number, Motion motion, const MatrixXd& part) {
  for (Index on = 0; on < part.rows(); ++on) {
    for (Index of = 0; of < part.cols(); ++of) {
      if (part(on, of) == 0.0) continue;
      entries_.push_back({number, on, motion, of, -part(on, of)});
    }
  }
}

void LinearTwin::MakeMaps() noexcept {
  const MechanicalModel& nominal = model_.nominal;
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
  MakeStep();
  MakeTick();
  LiftSensitivities();
}

void LinearTwin::MakeStep() noexcept {
  // v' = v + h (M + h D)^-1 (f - K q - D v), q' = q + h v'.
  const Index nq = M_.rows();
  const double h = model_.timing.step;
  left_side_ = M_ + h * D_;
  factor_.compute(left_side_);
  const auto into_velocity = [&](auto rows) {
    factor_.solveInPlace(rows);
    rows *= h;
  };
  pulse_step_.bottomRows(nq).setIdentity();
  into_velocity(pulse_step_.bottomRows(nq));
  pulse_step_.topRows(nq) = h * pulse_step_.bottomRows(nq);
  // Without the identity, whose rounding would be a spring to where x is 0.
  A_step_.bottomLeftCorner(nq, nq) = -K_;
  A_step_.bottomRightCorner(nq, nq) = -D_;
  into_velocity(A_step_.bottomRows(nq));
  A_step_.topRows(nq) = h * A_step_.bottomRows(nq);
  A_step_.topRightCorner(nq, nq).diagonal().array() += h;
  B_step_.noalias() = pulse_step_ * Gamma_;
  constant_.noalias() = pulse_step_ * f_;
  pulses_.back() = pulse_ = pulse_step_;
  for (std::size_t s = pulses_.size() - 1; s > 0; --s) {
    pulses_[s - 1] = pulses_[s];
    pulses_[s - 1].noalias() += A_step_ * pulses_[s];
    pulse_ += pulses_[s - 1];
  }
}

void LinearTwin::MakeTick() noexcept {
  const Index nx = states();
  before_.setZero();
  Index source = 0;
  for (const MatrixXd& pulse : pulses_) {
    after_ = before_;
    after_.noalias() += A_step_ * before_;
    after_.leftCols(nx) += A_step_;
    after_.middleCols(nx, B_step_.cols()) += B_step_;
    after_.rightCols(1) += constant_;
    MakeMoving(nx + source, before_, after_);
    for (const Moving& moving : moving_) {
      sources_.col(source++) = pulse.col(entries_[moving.first].on);
    }
    before_.swap(after_);
  }
  tick_.topRows(nx) = before_;
  for (const Held& held : held_) {
    sources_.col(source++).noalias() = pulse_ * held.direction;
  }
  for (std::size_t i = 0; i < tone_held_.size(); ++i) {
    Held& held = tone_held_[i];
    held.direction.noalias() = Gamma_ * tones_.amplitude(static_cast<Index>(i));
    sources_.col(source++).noalias() = pulse_ * held.direction;
  }
}

void LinearTwin::MakeMoving(Index row, const MatrixXd& before,
                            const MatrixXd& after) noexcept {
  const Index nq = M_.rows();
  for (const Moving& moving : moving_) {
    auto force = tick_.row(row++);
    force.setZero();
    for (std::size_t i = moving.first; i < moving.end; ++i) {
      const Entry& entry = entries_[i];
      switch (entry.motion) {
        case Motion::kPosition:
          force += entry.coefficient * before.row(entry.of);
          force[entry.of] += entry.coefficient;
          break;
        case Motion::kVelocity:
          force += entry.coefficient * after.row(nq + entry.of);
          force[nq + entry.of] += entry.coefficient;
          break;
        case Motion::kAcceleration:
          force += entry.coefficient / model_.timing.step *
                   (after.row(nq + entry.of) - before.row(nq + entry.of));
      }
    }
  }
}

void LinearTwin::UseGain(std::size_t gain) noexcept {
  if (gain == gain_) return;
  gain_ = gain;
  LiftSensitivities();
}

void LinearTwin::LiftSensitivities() noexcept {
  const Index nx = states();
  F_ = tick_.topLeftCorner(nx, nx);
  F_.diagonal().array() += 1.0;
  F_.noalias() -= gain().L * C_;
  base_ = F_;
  power_.setIdentity();
  for (Index left = block(); left > 0; left /= 2) {
    if (left % 2 != 0) {
      scratch_.noalias() = base_ * power_;
      power_.swap(scratch_);
    }
    if (left > 1) {
      scratch_.noalias() = base_ * base_;
      base_.swap(scratch_);
    }
  }
  const Index ny = outputs();
  carry_.topRows(ny) = C_;
  for (Index i = 1; i < block(); ++i) {
    carry_.middleRows(i * ny, ny).noalias() = carry_.middleRows((i - 1) * ny, ny) * F_;
  }
  carry_.middleRows(seen(), nx) = power_;
  left_.back().topRows(seen()).setZero();
  left_.back().middleRows(seen(), nx) = sources_;
  for (auto j = static_cast<Index>(left_.size()) - 1; j > 0; --j) {
    // Of tick j - 1 is seen in every tick what is seen of tick j one later.
    const MatrixXd& later = left_[static_cast<std::size_t>(j)];
    MatrixXd& now = left_[static_cast<std::size_t>(j - 1)];
    now.topRows(seen() - ny) = later.middleRows(ny, seen() - ny);
    now.middleRows(seen() - ny, ny).noalias() = C_ * later.middleRows(seen(), nx);
    now.middleRows(seen(), nx).noalias() = F_ * later.middleRows(seen(), nx);
  }
}

void LinearTwin::Start(const VectorXd& theta) noexcept {
  Begin(theta, true, 0);
  Reset();
  moved_rest_.Find(theta_);
  x_.head(M_.rows()) = moved_rest_.position();
  S_.topRows(M_.rows()) = moved_rest_.sensitivity();
}

void LinearTwin::Start(const VectorXd& theta, const TwinState& state,
                       Index tick) noexcept {
  Begin(theta, false, tick);
  Reset();
  Place(state, model_.start);
}

void LinearTwin::Reset() noexcept {
  in_block_ = 0;
  x_.setZero();
  S_.setZero();
  block_.setZero();
  MakeMaps();
}

void LinearTwin::StateAt(const VectorXd& reading, TwinState& state) noexcept {
  state.S.setZero();
  state.x.setZero();
  state.x.head(M_.rows()).noalias() = place_ * reading;
  state.x.head(M_.rows()).noalias() -= place_ * model_.rest;
}

void LinearTwin::Predict(VectorXd& reading) noexcept {
  reading = model_.rest;
  reading.noalias() += C_ * x_;
}

void LinearTwin::Push() noexcept {
  auto weight = static_cast<Index>(moving_.size() * pulses_.size());
  weights_.head(weight) = end_.segment(states(), weight);
  for (const Held& held : held_) {
    weights_[weight++] = held.input == kNoInput ? 1.0 : u_[held.input];
  }
  for (Index i = 0; i < tones_.count(); ++i) {
    weights_[weight++] = tones_.sine(i);
    weights_[weight++] = tones_.cosine(i);
  }
  WideAdd(terms_, weights_.data(), left_[static_cast<std::size_t>(in_block_)], block_);
}

void LinearTwin::Step(std::span<const double> inputs,
                      const VectorXd& innovation) noexcept {
  Command(inputs);
  start_.head(x_.size()) = x_;
  start_.segment(x_.size(), u_.size()) = u_;
  WideProduct(tick_, start_.data(), end_.data());
  Push();
  x_ += end_.head(x_.size());
  x_.noalias() += gain().L * innovation;
  tones_.Advance();
  ++in_block_;
}

const MatrixXd& LinearTwin::EndBlock() noexcept {
  sensitivity_.setZero();
  S_next_.setZero();
  const auto of_readings = block_.topRows(seen());
  const auto at_end = block_.middleRows(seen(), states());
  Index column = 0;
  for (const ModelPart& part : model_.parts) {
    const double value = values_[column];
    for (const Index factor : part.factors) {
      S_next_.col(factor) += value * at_end.col(column);
      sensitivity_.col(factor) += value * of_readings.col(column);
    }
    ++column;
  }
  const Index of_tones = 2 * tones_.count();
  S_next_.middleCols(first_tone(), of_tones) = at_end.rightCols(of_tones);
  sensitivity_.middleCols(first_tone(), of_tones) = of_readings.rightCols(of_tones);
  // S_next_ and sensitivity_ hold what the forces of the block have left, so far.
  if (drifts_) LiftDrift();
  for (Index i = 0; i < acting(); ++i) {
    WideProduct(carry_, S_.col(i).data(), carried_.data());
    sensitivity_.col(i) += carried_.head(seen());
    S_next_.col(i) += carried_.segment(seen(), states());
  }
  S_.swap(S_next_);
  block_.setZero();
  in_block_ = 0;
  return sensitivity_;
}

void LinearTwin::LiftDrift() noexcept {
  const double length = static_cast<double>(block()) * sample_time_;
  const double grown = drift_time_ + 0.5 * length;
  drift_time_ += length;
  for (Index i = 0; i < S_rate_.cols(); ++i) {
    const Index of = drifting_[static_cast<std::size_t>(i)];
    WideProduct(carry_, S_rate_.col(i).data(), carried_.data());
    drift_.col(i) = carried_.head(seen()) + grown * sensitivity_.col(of);
    S_rate_next_.col(i) = carried_.segment(seen(), states()) + grown * S_next_.col(of);
  }
  S_rate_.swap(S_rate_next_);
}

void LinearTwin::Drifted(const VectorXd& rates) noexcept {
  for (Index i = 0; i < rates.size(); ++i) {
    theta_[drifting_[static_cast<std::size_t>(i)]] += drift_time_ * rates[i];
  }
  x_.noalias() += S_rate_ * rates;
  MakeMaps();
}

void LinearTwin::Shift(const VectorXd& change) noexcept {
  theta_ += change;
  x_.noalias() += S_ * change;
  MakeMaps();
}

}  // namespace mjdiag
