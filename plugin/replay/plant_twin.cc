#include "mjdiag/plugin/replay/plant_twin.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/plant/tendon_moment.h"
#include "mjdiag/signals/wide_product.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A joint that comes loose a tick too late is off by much more than its force was.
constexpr double kCurvature = 12.0;

std::vector<PlacedEffect> FrictionOf(std::vector<PlacedEffect> effects) {
  std::erase_if(effects, [](const PlacedEffect& effect) {
    return effect.effect->family() != Family::kFriction;
  });
  return effects;
}

/// How the force of a number is known along a run.
enum class Law { kJoint, kTendonFriction, kGear, kInertia, kAtRest };

Law LawOf(const mjModel& model, const ModelParameter& number) {
  switch (number.kind) {
    case ModelParameterKind::kStiffness:
    case ModelParameterKind::kDamping:
    case ModelParameterKind::kFriction:
      return Law::kJoint;
    case ModelParameterKind::kTendonFriction:
      return Law::kTendonFriction;
    case ModelParameterKind::kMass:
    case ModelParameterKind::kInertia:
    case ModelParameterKind::kArmature:
      return Law::kInertia;
    case ModelParameterKind::kGear:
      // Behind it a bias acts, too.
      return model.actuator_biastype[number.element] == mjBIAS_AFFINE ? Law::kAtRest
                                                                      : Law::kGear;
    default:
      return Law::kAtRest;
  }
}

std::vector<ModelPart> PartsOf(const UncertainMachine& uncertain) {
  std::vector<ModelPart> parts;
  for (const UncertainNumber& number : uncertain.numbers) parts.push_back(number.part);
  return parts;
}

}  // namespace

PlantTwin::PlantTwin(const Machine& machine, UncertainMachine uncertain,
                     std::vector<TwinGain> gains, Index block)
    : Twin(
          {machine.linear().b.cols(), machine.linear().Gamma.cols(),
           2 * machine.linear().M.rows(), static_cast<Index>(uncertain.unknowns.size()),
           uncertain.start.cols(), block, kCurvature, false},
          std::move(gains), uncertain.tones, machine.rates().tick(),
          DriftingOf(uncertain.unknowns)),
      machine_(machine),
      uncertain_(std::move(uncertain)),
      effects_(machine.channels(), machine.plant(), machine.effects()),
      friction_(machine.channels(), machine.plant(), FrictionOf(machine.effects())),
      moved_rest_(machine.linear(), PartsOf(uncertain_), unknowns()),
      moments_(TendonMoments(machine.plant(), machine.rest().data())),
      maps_(moments_) {
  StartedPlant plant = StartPlant(machine, {});
  model_ = std::move(plant.model);
  data_ = std::move(plant.data);
  start_ = VectorXd::Map(data_->qpos, model_->nq);
  const MechanicalModel& linear = machine.linear();
  const Index nv = model_->nv;
  const Index ny = linear.b.cols();
  const Index nu = linear.Gamma.cols();
  const auto p = static_cast<Index>(uncertain_.unknowns.size());
  C_ = linear.b.transpose();
  Gamma_ = linear.Gamma;
  M_ = M_now_ = linear.M;
  K_ = linear.K;
  D_ = linear.D;
  K_rest_ = K_ - MatrixXd(JointStiffness(*model_).asDiagonal());
  D_rest_ = D_ - MatrixXd(VectorXd::Map(model_->dof_damping, nv).asDiagonal());
  for (const UncertainNumber& known : uncertain_.numbers) {
    Number number{known.number, known.part.factors};
    const int element = known.number.element;
    heavy_ = heavy_ || IsDerivedFrom(known.number.kind);
    switch (LawOf(*model_, known.number)) {
      case Law::kJoint:
        number.at = model_->jnt_dofadr[element];
        break;
      case Law::kTendonFriction:
        number.at = element;
        break;
      case Law::kGear: {
        const auto& addresses = machine.actuator_addresses();
        const auto at = std::find(addresses.begin(), addresses.end(), element);
        if (at == addresses.end()) continue;  // nothing drives it
        number.at = static_cast<int>(at - addresses.begin());
        number.at_command = true;
        break;
      }
      case Law::kInertia:
        number.inertial = true;
        number.part = known.part;
        break;
      case Law::kAtRest:
        number.part = known.part;
        break;
    }
    numbers_.push_back(std::move(number));
  }
  for (const UncertainResistance& known : uncertain_.resistances) {
    resistances_.push_back({model_->jnt_dofadr[known.joint], known.unknown});
  }
  place_ = PlacementOf(linear);
  state_ = VectorXd::Zero(2 * nv);
  before_ = acceleration_ = work_force_ = VectorXd::Zero(nv);
  lifted_ = by_force_ = VectorXd::Zero(WideRows(nv));
  tone_ = VectorXd::Zero(nu);
  outputs_.resize(static_cast<std::size_t>(ny));
  drive_ = force_ = MatrixXd::Zero(nv, p);
  sensitivity_ = MatrixXd::Zero(ny * block, p);
  drift_force_ = MatrixXd::Zero(nv, S_rate_.cols());
  UseGain(0);
}

void PlantTwin::SetParameters() noexcept {
  M_now_ = M_;
  for (Number& number : numbers_) {
    const double sum = Logarithm(number.factors);
    const double factor = std::exp(sum);
    const bool additive = IsAdditive(number.number.kind);
    number.slope = additive ? 1.0 : factor;
    number.change = additive ? sum : std::expm1(sum);
    SetNumber(*model_, machine_.plant(), number.number, factor);
    if (number.part.M.size() > 0) M_now_ += number.change * number.part.M;
  }
  for (Resistance& resistance : resistances_) {
    resistance.times = std::exp(theta_[resistance.unknown]);
  }
  maps_.Forget();
}

const StickingMaps::Map& PlantTwin::MapOf(std::uint64_t sticking) noexcept {
  if (const StickingMaps::Map* const known = maps_.Find(sticking)) return *known;
  const Index nv = model_->nv;
  D_ = D_rest_;
  D_.diagonal() += VectorXd::Map(model_->dof_damping, nv);
  K_ = K_rest_;
  for (int j = 0; j < nv; ++j) {
    K_(j, j) += model_->jnt_stiffness[model_->dof_jntid[j]];
  }
  for (const Number& number : numbers_) {
    if (number.inertial) continue;
    if (number.part.K.size() > 0) K_ += number.change * number.part.K;
    if (number.part.D.size() > 0) D_ += number.change * number.part.D;
  }
  return maps_.Make(sticking, M_now_, K_, D_, model_->opt.timestep);
}

void PlantTwin::Reset() noexcept {
  time_ = 0.0;
  SetParameters();
  if (const std::vector<PlacedEffect> effects = machine_.effects(); !effects.empty()) {
    effects_ = ActiveEffects(machine_.channels(), *model_, effects);
    friction_ = ActiveEffects(machine_.channels(), *model_, FrictionOf(effects));
  }
  // What MuJoCo derives from masses, in data that are reset anyway.
  if (heavy_) mj_setConst(model_.get(), data_.get());
  mj_resetData(model_.get(), data_.get());
  VectorXd::Map(data_->qpos, start_.size()) = start_;
  S_.setZero();
  sensitivity_.setZero();
  in_block_ = 0;
}

void PlantTwin::Start(const VectorXd& theta) noexcept {
  Begin(theta, true, 0);
  Reset();
  moved_rest_.Find(theta_);
  VectorXd::Map(data_->qpos, model_->nv) += moved_rest_.position();
  S_.topRows(model_->nv) = moved_rest_.sensitivity();
}

void PlantTwin::Start(const VectorXd& theta, const TwinState& state,
                      Index tick) noexcept {
  Begin(theta, false, tick);
  Reset();
  time_ = data_->time = static_cast<double>(tick) * machine_.rates().tick();
  const Index nv = model_->nv;
  Place(state, uncertain_.start);
  VectorXd::Map(data_->qpos, nv) += x_.head(nv);
  VectorXd::Map(data_->qvel, nv) = x_.tail(nv);
}

void PlantTwin::StateAt(const VectorXd& reading, TwinState& state) noexcept {
  VectorXd::Map(data_->qpos, start_.size()) = start_;
  VectorXd::Map(data_->qvel, model_->nv).setZero();
  mj_step1(model_.get(), data_.get());
  state.S.setZero();
  state.x.setZero();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const double rest = data_->sensordata[machine_.sensor_addresses()[i]];
    const auto at = static_cast<Index>(i);
    state.x.head(model_->nv) += (reading[at] - rest) * place_.col(at);
  }
}

void PlantTwin::ReadState(TwinState& state) const noexcept {
  Twin::ReadState(state);
  const Index nv = model_->nv;
  state.x.head(nv) = VectorXd::Map(data_->qpos, nv) - start_;
  state.x.tail(nv) = VectorXd::Map(data_->qvel, nv);
}

void PlantTwin::Predict(VectorXd& reading) noexcept {
  mj_step1(model_.get(), data_.get());
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    outputs_[i] = data_->sensordata[machine_.sensor_addresses()[i]];
  }
  effects_.Distort(*model_, *data_, outputs_, time_);
  reading = VectorXd::Map(outputs_.data(), reading.size());
}

void PlantTwin::AddForce(MatrixXd& forces, const Number& number, Index dof,
                         double force) const noexcept {
  for (const Index factor : number.factors) forces(dof, factor) += force;
}

void PlantTwin::AddWorkForce(const Number& number) noexcept {
  for (const Index factor : number.factors) {
    force_.col(factor) += number.slope * work_force_;
  }
}

/// Of what slides.
void PlantTwin::AddFriction(int type, Index at, double force) noexcept {
  const bool of_dof = type == mjCNSTR_FRICTION_DOF;
  const ModelParameterKind kind =
      of_dof ? ModelParameterKind::kFriction : ModelParameterKind::kTendonFriction;
  for (const Number& number : numbers_) {
    if (number.number.kind != kind || number.at != at) continue;
    if (of_dof) {
      AddForce(force_, number, at, force);
      continue;
    }
    for (const Index factor : number.factors) {
      force_.col(factor) += force * moments_.col(at);
    }
  }
}

void PlantTwin::AddTickForces() noexcept {
  drive_.setZero();
  const Index first = first_tone();
  for (Index i = 0; i < tones_.count(); ++i) {
    tone_ = tones_.amplitude(i);
    for (const Number& number : numbers_) {
      if (number.at_command) tone_[number.at] *= number.slope;
    }
    auto sine = drive_.col(first + 2 * i);
    auto cosine = drive_.col(first + 2 * i + 1);
    cosine.noalias() = Gamma_ * tone_;
    sine = tones_.sine(i) * cosine;
    cosine *= tones_.cosine(i);
  }
  for (const Number& number : numbers_) {
    for (const Index factor : number.factors) {
      if (number.at_command) {
        drive_.col(factor) += number.slope * u_[number.at] * Gamma_.col(number.at);
      }
      if (number.part.Gamma.size() == 0) continue;
      work_force_.noalias() = number.part.Gamma * u_;
      drive_.col(factor) += number.slope * work_force_;
    }
  }
}

void PlantTwin::Act() noexcept {
  if (!resistances_.empty()) friction_.Act(*model_, *data_);
  for (Resistance& resistance : resistances_) {
    resistance.force = data_->qfrc_applied[resistance.dof];
  }
  effects_.Act(*model_, *data_);
  for (const Resistance& resistance : resistances_) {
    data_->qfrc_applied[resistance.dof] += (resistance.times - 1.0) * resistance.force;
  }
}

void PlantTwin::AddStepForces() noexcept {
  force_ = drive_;
  for (const Resistance& resistance : resistances_) {
    force_(resistance.dof, resistance.unknown) += resistance.times * resistance.force;
  }
  const Index nv = model_->nv;
  for (const Number& number : numbers_) {
    if (number.number.kind == ModelParameterKind::kStiffness) {
      const int address = model_->jnt_qposadr[number.number.element];
      AddForce(force_, number, number.at,
               -model_->jnt_stiffness[number.number.element] *
                   (data_->qpos[address] - model_->qpos_spring[address]));
    }
    const ModelPart& part = number.part;
    if (part.K.size() + part.force.size() == 0) continue;
    work_force_.setZero();
    if (part.force.size() > 0) work_force_ = part.force;
    if (part.K.size() > 0) {
      state_.head(nv) = VectorXd::Map(data_->qpos, nv) - start_;
      work_force_.noalias() -= part.K * state_.head(nv);
    }
    AddWorkForce(number);
  }
}

void PlantTwin::Step(std::span<const double> inputs,
                     const VectorXd& innovation) noexcept {
  const Index nv = model_->nv;
  const Index row = in_block_++ * outputs();
  auto read = sensitivity_.middleRows(row, outputs()).leftCols(acting());
  auto drift_read = drift_.middleRows(row, outputs());
  read.noalias() = C_ * S_.topRows(nv).leftCols(acting());
  if (drifts_) drift_read.noalias() = C_ * S_rate_.topRows(nv);
  Command(inputs);
  AddTickForces();
  for (int substep = 0; substep < machine_.rates().substeps; ++substep) {
    if (substep > 0) mj_step1(model_.get(), data_.get());
    for (Index i = 0; i < u_.size(); ++i) {
      data_->ctrl[machine_.actuator_addresses()[static_cast<std::size_t>(i)]] = u_[i];
    }
    Act();
    AddStepForces();
    before_ = VectorXd::Map(data_->qvel, nv);
    mj_step2(model_.get(), data_.get());
    Substep();
  }
  tones_.Advance();
  if (pulled_) {
    const MatrixXd& L = gain().L;
    state_.noalias() = L * innovation;
    VectorXd::Map(data_->qpos, nv) += state_.head(nv);
    VectorXd::Map(data_->qvel, nv) += state_.tail(nv);
    S_.leftCols(acting()).noalias() -= L * read;
    if (drifts_) S_rate_.noalias() -= L * drift_read;
  }
  time_ += machine_.rates().tick();
  drift_time_ += machine_.rates().tick();
}

void PlantTwin::Substep() noexcept {
  const Index nv = model_->nv;
  std::uint64_t sticking = 0;
  for (int row = 0; row < data_->nefc; ++row) {
    const int type = data_->efc_type[row];
    if (type != mjCNSTR_FRICTION_DOF && type != mjCNSTR_FRICTION_TENDON) continue;
    const int at = data_->efc_id[row];
    if (data_->efc_state[row] != mjCNSTRSTATE_QUADRATIC) {
      AddFriction(type, at, data_->efc_force[row]);
      continue;
    }
    const Index place = type == mjCNSTR_FRICTION_DOF ? at : nv + at;
    sticking |= std::uint64_t{1} << place;
    const double r = data_->efc_D[row];
    maps_.Hold(place, r, r * data_->efc_KBIP[4 * row + 1]);
  }
  acceleration_ = (VectorXd::Map(data_->qvel, nv) - before_) / model_->opt.timestep;
  for (const Number& number : numbers_) {
    if (number.number.kind == ModelParameterKind::kDamping) {
      AddForce(force_, number, number.at,
               -model_->dof_damping[number.at] * data_->qvel[number.at]);
    }
    if (number.part.D.size() > 0) {
      work_force_.noalias() = -number.part.D * VectorXd::Map(data_->qvel, nv);
      AddWorkForce(number);
    }
    if (number.part.M.size() == 0) continue;
    work_force_.noalias() = -number.part.M * acceleration_;
    AddWorkForce(number);
  }
  const StickingMaps::Map& map = MapOf(sticking);
  Lift(map, acting(), theta_.size() - start_unknowns(), force_, S_);
  if (!drifts_) return;
  for (Index i = 0; i < drift_force_.cols(); ++i) {
    drift_force_.col(i) =
        drift_time_ * force_.col(drifting_[static_cast<std::size_t>(i)]);
  }
  Lift(map, S_rate_.cols(), S_rate_.cols(), drift_force_, S_rate_);
}

void PlantTwin::Lift(const StickingMaps::Map& map, Index count, Index forced,
                     const MatrixXd& force, MatrixXd& S) noexcept {
  const Index nv = model_->nv;
  for (Index i = 0; i < count; ++i) {
    WideProduct(map.QV, S.col(i).data(), lifted_.data());
    if (i < forced) {
      WideProduct(map.G, force.col(i).data(), by_force_.data());
      lifted_ += by_force_;
    }
    S.col(i).tail(nv) = lifted_.head(nv);
    S.col(i).head(nv) += model_->opt.timestep * lifted_.head(nv);
  }
}

const MatrixXd& PlantTwin::EndBlock() noexcept {
  in_block_ = 0;
  return sensitivity_;
}

void PlantTwin::Shift(const VectorXd& change) noexcept {
  const Index nv = model_->nv;
  theta_ += change;
  VectorXd::Map(data_->qpos, nv).noalias() += S_.topRows(nv) * change;
  VectorXd::Map(data_->qvel, nv).noalias() += S_.bottomRows(nv) * change;
  SetParameters();
}

void PlantTwin::Drifted(const VectorXd& rates) noexcept {
  const Index nv = model_->nv;
  for (Index i = 0; i < rates.size(); ++i) {
    theta_[drifting_[static_cast<std::size_t>(i)]] += drift_time_ * rates[i];
  }
  VectorXd::Map(data_->qpos, nv).noalias() += S_rate_.topRows(nv) * rates;
  VectorXd::Map(data_->qvel, nv).noalias() += S_rate_.bottomRows(nv) * rates;
  SetParameters();
}

}  // namespace mjdiag
