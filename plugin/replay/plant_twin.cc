#include "mjdiag/plugin/replay/plant_twin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFactorSpread = 0.1;
constexpr double kStartEnergy = 1e-7;  // J

VectorXd SpringsOf(const mjModel& plant) {
  VectorXd stiffness(plant.nv);
  for (int j = 0; j < plant.nv; ++j) {
    stiffness[j] = plant.jnt_stiffness[plant.dof_jntid[j]];
  }
  return stiffness;
}

}  // namespace

UncertainPlant MakeUncertainPlant(const Machine& machine) {
  UncertainPlant uncertain;
  const mjModel& plant = machine.plant();
  uncertain.faults = FaultParameters(plant);
  for (const FaultParameter& fault : uncertain.faults) {
    uncertain.unknowns.push_back({fault.name, 1.0, kFactorSpread, true});
  }
  for (int dof = 0; dof < plant.nv; ++dof) {
    if (plant.dof_frictionloss[dof] <= 0.0) continue;
    uncertain.rubbing.push_back(dof);
    uncertain.unknowns.push_back(
        {"friction@" + ElementName(plant, mjOBJ_JOINT, plant.dof_jntid[dof]), 1.0,
         kFactorSpread, true});
  }
  for (const MultisineSetup& source : machine.setup().disturbances) {
    VectorXd amplitude =
        VectorXd::Zero(static_cast<Index>(machine.channels().actuators.size()));
    for (const auto& [channel, value] : source.amplitude) {
      amplitude[machine.channels().ActuatorIndex(channel)] = value;
    }
    for (const double frequency : source.frequencies) {
      uncertain.tones.push_back({frequency, amplitude});
      uncertain.unknowns.push_back({source.name + " sine", 0.0, 0.1, false});
      uncertain.unknowns.push_back({source.name + " cosine", 0.0, 0.1, false});
    }
  }
  uncertain.start = StartDirections(machine.linear(), kStartEnergy);
  for (Index i = 0; i < uncertain.start.cols(); ++i) {
    uncertain.unknowns.push_back({"start " + std::to_string(i + 1), 0.0, 1.0, false});
  }
  return uncertain;
}

PlantTwin::PlantTwin(const Machine& machine, UncertainPlant uncertain,
                     const MatrixXd& gain, Index block)
    : machine_(machine),
      uncertain_(std::move(uncertain)),
      L_(gain),
      block_(block),
      effects_(machine.channels(), machine.plant(), machine.effects()) {
  StartedPlant plant = StartPlant(machine, {});
  model_ = std::move(plant.model);
  data_ = std::move(plant.data);
  ChooseSolver(*model_);
  start_ = VectorXd::Map(data_->qpos, model_->nq);
  const MechanicalModel& linear = machine.linear();
  const Index nv = model_->nv;
  const Index ny = linear.b.cols();
  const Index nu = linear.Gamma.cols();
  const auto p = static_cast<Index>(uncertain_.unknowns.size());
  C_ = linear.b.transpose();
  Gamma_ = linear.Gamma;
  M_ = linear.M;
  K_ = linear.K;
  D_ = linear.D;
  K_rest_ = K_ - MatrixXd(SpringsOf(*model_).asDiagonal());
  D_rest_ = D_ - MatrixXd(VectorXd::Map(model_->dof_damping, nv).asDiagonal());
  for (std::size_t i = 0; i < uncertain_.faults.size(); ++i) {
    const FaultParameter& fault = uncertain_.faults[i];
    const auto unknown = static_cast<Index>(i);
    for (const int element : fault.elements) {
      if (fault.kind == FaultParameterKind::kGear) {
        const auto& addresses = machine.actuator_addresses();
        const auto at = std::find(addresses.begin(), addresses.end(), element);
        if (at != addresses.end()) gears_.push_back({unknown, at - addresses.begin()});
        continue;
      }
      const int dof = model_->jnt_dofadr[element];
      if (fault.kind == FaultParameterKind::kDamping) {
        dampers_.push_back({unknown, dof, -model_->dof_damping[dof]});
      } else {
        springs_.push_back({unknown, dof, -model_->jnt_stiffness[element]});
      }
    }
  }
  start_directions_ = uncertain_.start;
  place_ = PlacementOf(linear);
  remembered_ = state_ = VectorXd::Zero(2 * nv);
  theta_ = slope_ = VectorXd::Zero(p);
  for (Map& map : maps_) map.Q = map.V = map.G = MatrixXd::Zero(nv, nv);
  inertia_ = identity_ = work_ = MatrixXd::Identity(nv, nv);
  factor_ = Eigen::LLT<MatrixXd>(nv);
  stick_r_.assign(static_cast<std::size_t>(nv), 0.0);
  stick_rb_ = stick_r_;
  u_ = tone_ = VectorXd::Zero(nu);
  phase_ = VectorXd::Zero(2 * static_cast<Index>(uncertain_.tones.size()));
  turn_ = phase_;
  for (std::size_t i = 0; i < uncertain_.tones.size(); ++i) {
    const double angle =
        2.0 * std::numbers::pi * uncertain_.tones[i].frequency * machine.rates().tick();
    turn_[2 * static_cast<Index>(i)] = std::sin(angle);
    turn_[2 * static_cast<Index>(i) + 1] = std::cos(angle);
  }
  outputs_.resize(static_cast<std::size_t>(ny));
  S_ = MatrixXd::Zero(2 * nv, p);
  drive_ = drive_work_ = force_ = MatrixXd::Zero(nv, p);
  sensitivity_ = sum_ = MatrixXd::Zero(ny, p);
}

void PlantTwin::SetParameters() noexcept {
  for (Index i = 0; i < theta_.size(); ++i) {
    const bool factor = uncertain_.unknowns[static_cast<std::size_t>(i)].factor;
    slope_[i] = factor ? std::exp(theta_[i]) : 1.0;
  }
  for (const Pull& damper : dampers_) {
    model_->dof_damping[damper.dof] =
        slope_[damper.unknown] * machine_.plant().dof_damping[damper.dof];
  }
  for (const Pull& spring : springs_) {
    const int joint = model_->dof_jntid[spring.dof];
    model_->jnt_stiffness[joint] =
        slope_[spring.unknown] * machine_.plant().jnt_stiffness[joint];
  }
  for (const Gear& gear : gears_) {
    const int actuator =
        machine_.actuator_addresses()[static_cast<std::size_t>(gear.input)];
    mju_scl(model_->actuator_gear + 6 * actuator,
            machine_.plant().actuator_gear + 6 * actuator, slope_[gear.unknown], 6);
  }
  auto unknown = static_cast<Index>(uncertain_.faults.size());
  for (const int dof : uncertain_.rubbing) {
    model_->dof_frictionloss[dof] =
        slope_[unknown++] * machine_.plant().dof_frictionloss[dof];
  }
  for (Map& map : maps_) map.known = false;
}

const PlantTwin::Map& PlantTwin::MapOf(std::uint64_t sticking) noexcept {
  for (const Map& map : maps_) {
    if (map.known && map.sticking == sticking) return map;
  }
  Map& map = maps_[next_map_];
  next_map_ = (next_map_ + 1) % maps_.size();
  map.sticking = sticking;
  map.known = true;
  const Index nv = model_->nv;
  const double h = model_->opt.timestep;
  D_ = D_rest_;
  D_.diagonal() += VectorXd::Map(model_->dof_damping, nv);
  K_ = K_rest_;
  for (int j = 0; j < nv; ++j) {
    K_(j, j) += model_->jnt_stiffness[model_->dof_jntid[j]];
  }
  // G = h (M + h D)^-1 M W^-1
  inertia_ = M_;
  for (Index j = 0; j < nv; ++j) {
    if ((sticking >> j & 1) != 0)
      inertia_(j, j) += stick_r_[static_cast<std::size_t>(j)];
  }
  factor_.compute(inertia_);
  work_ = identity_;
  factor_.solveInPlace(work_);
  map.G.noalias() = M_ * work_;
  inertia_ = M_ + h * D_;
  factor_.compute(inertia_);
  factor_.solveInPlace(map.G);
  map.G *= h;
  map.Q.noalias() = -map.G * K_;
  for (Index j = 0; j < nv; ++j) {
    if ((sticking >> j & 1) != 0) D_(j, j) += stick_rb_[static_cast<std::size_t>(j)];
  }
  map.V = identity_;
  map.V.noalias() -= map.G * D_;
  return map;
}

void PlantTwin::Start(const VectorXd& theta, bool at_rest) noexcept {
  theta_ = theta;
  time_ = 0.0;
  in_block_ = 0;
  SetParameters();
  if (const std::vector<PlacedEffect> effects = machine_.effects(); !effects.empty()) {
    effects_ = ActiveEffects(machine_.channels(), *model_, effects);
  }
  mj_resetData(model_.get(), data_.get());
  VectorXd::Map(data_->qpos, start_.size()) = start_;
  S_.setZero();
  sum_.setZero();
  const Index nv = model_->nv;
  const Index k = start_directions_.cols();
  active_ = theta_.size() - (at_rest ? k : 0);
  if (!at_rest) {
    state_ = remembered_;
    state_.noalias() += start_directions_ * theta_.tail(k);
    VectorXd::Map(data_->qpos, nv) += state_.head(nv);
    VectorXd::Map(data_->qvel, nv) = state_.tail(nv);
    S_.rightCols(k) = start_directions_;
  }
  for (std::size_t i = 0; i < uncertain_.tones.size(); ++i) {
    phase_[2 * static_cast<Index>(i)] = 0.0;
    phase_[2 * static_cast<Index>(i) + 1] = 1.0;
  }
}

void PlantTwin::Place(const VectorXd& reading) noexcept {
  mj_step1(model_.get(), data_.get());
  VectorXd::Map(data_->qvel, model_->nv).setZero();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const double rest = data_->sensordata[machine_.sensor_addresses()[i]];
    const auto at = static_cast<Index>(i);
    VectorXd::Map(data_->qpos, model_->nv) += (reading[at] - rest) * place_.col(at);
  }
}

void PlantTwin::Remember() noexcept {
  const Index nv = model_->nv;
  remembered_.head(nv) = VectorXd::Map(data_->qpos, nv) - start_;
  remembered_.tail(nv) = VectorXd::Map(data_->qvel, nv);
}

void PlantTwin::Predict(VectorXd& reading) noexcept {
  mj_step1(model_.get(), data_.get());
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    outputs_[i] = data_->sensordata[machine_.sensor_addresses()[i]];
  }
  effects_.Distort(outputs_, time_);
  reading = VectorXd::Map(outputs_.data(), reading.size());
}

void PlantTwin::Step(std::span<const double> inputs,
                     const VectorXd& innovation) noexcept {
  sum_.leftCols(active_).noalias() += C_ * S_.topRows(model_->nv).leftCols(active_);
  u_ = VectorXd::Map(inputs.data(), u_.size());
  const Index first = theta_.size() - start_directions_.cols() - phase_.size();
  for (std::size_t i = 0; i < uncertain_.tones.size(); ++i) {
    const Index at = 2 * static_cast<Index>(i);
    u_ += (theta_[first + at] * phase_[at] + theta_[first + at + 1] * phase_[at + 1]) *
          uncertain_.tones[i].amplitude;
  }
  // What does not change within the tick.
  drive_.setZero();
  for (const Gear& gear : gears_) {
    drive_.col(gear.unknown) +=
        slope_[gear.unknown] * u_[gear.input] * Gamma_.col(gear.input);
  }
  for (std::size_t i = 0; i < uncertain_.tones.size(); ++i) {
    const Index at = 2 * static_cast<Index>(i);
    tone_ = uncertain_.tones[i].amplitude;
    for (const Gear& gear : gears_) tone_[gear.input] *= slope_[gear.unknown];
    drive_.col(first + at + 1).noalias() = Gamma_ * tone_;
    drive_.col(first + at) = phase_[at] * drive_.col(first + at + 1);
    drive_.col(first + at + 1) *= phase_[at + 1];
  }
  for (int substep = 0; substep < machine_.rates().substeps; ++substep) {
    if (substep > 0) mj_step1(model_.get(), data_.get());
    for (Index i = 0; i < u_.size(); ++i) {
      data_->ctrl[machine_.actuator_addresses()[static_cast<std::size_t>(i)]] = u_[i];
    }
    effects_.Act(*model_, *data_);
    force_ = drive_;
    for (const Pull& spring : springs_) {
      const int joint = model_->dof_jntid[spring.dof];
      const int address = model_->jnt_qposadr[joint];
      force_(spring.dof, spring.unknown) +=
          slope_[spring.unknown] * spring.coefficient *
          (data_->qpos[address] - model_->qpos_spring[address]);
    }
    mj_step2(model_.get(), data_.get());
    Substep();
  }
  for (Index i = 0; i < phase_.size(); i += 2) {
    const double sine = phase_[i];
    const double cosine = phase_[i + 1];
    phase_[i] = sine * turn_[i + 1] + cosine * turn_[i];
    phase_[i + 1] = cosine * turn_[i + 1] - sine * turn_[i];
  }
  state_.noalias() = L_ * innovation;
  VectorXd::Map(data_->qpos, model_->nv) += state_.head(model_->nv);
  VectorXd::Map(data_->qvel, model_->nv) += state_.tail(model_->nv);
  time_ += machine_.rates().tick();
  ++in_block_;
}

void PlantTwin::Substep() noexcept {
  for (const Pull& damper : dampers_) {
    force_(damper.dof, damper.unknown) +=
        slope_[damper.unknown] * damper.coefficient * data_->qvel[damper.dof];
  }
  std::uint64_t sticking = 0;
  for (int row = 0; row < data_->nefc; ++row) {
    if (data_->efc_type[row] != mjCNSTR_FRICTION_DOF) continue;
    const int dof = data_->efc_id[row];
    if (data_->efc_state[row] == mjCNSTRSTATE_QUADRATIC) {
      sticking |= std::uint64_t{1} << dof;
      stick_r_[static_cast<std::size_t>(dof)] = data_->efc_D[row];
      stick_rb_[static_cast<std::size_t>(dof)] =
          data_->efc_D[row] * data_->efc_KBIP[4 * row + 1];
      continue;
    }
    const auto at =
        std::find(uncertain_.rubbing.begin(), uncertain_.rubbing.end(), dof);
    if (at == uncertain_.rubbing.end()) continue;
    const Index unknown = static_cast<Index>(uncertain_.faults.size()) +
                          (at - uncertain_.rubbing.begin());
    force_(dof, unknown) += data_->efc_force[row];  // slope * nominal, with its sign
  }
  const Map& map = MapOf(sticking);
  const Index nv = model_->nv;
  // S_v' = Q S_q + V S_v + G f
  auto next = drive_work_.leftCols(active_);
  next.noalias() = map.Q * S_.topRows(nv).leftCols(active_);
  next.noalias() += map.V * S_.bottomRows(nv).leftCols(active_);
  const Index forced = theta_.size() - start_directions_.cols();
  next.leftCols(forced).noalias() += map.G * force_.leftCols(forced);
  S_.bottomRows(nv).leftCols(active_) = next;
  S_.topRows(nv).leftCols(active_) += model_->opt.timestep * next;
}

const MatrixXd& PlantTwin::EndBlock() noexcept {
  sensitivity_ = sum_ / static_cast<double>(block_);
  sum_.setZero();
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

}  // namespace mjdiag
