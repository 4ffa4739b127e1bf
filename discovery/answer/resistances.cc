#include "mjdiag/discovery/answer/resistances.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/fit/tick_columns.h"
#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Of so many samples a curve is made, and of so many speeds.
constexpr Index kSamples = 4000;
constexpr Index kSpeeds = 12;

/// The samples in which a joint moves, and how fast.
struct Moving {
  std::vector<Index> samples;
  VectorXd speed;
};

Moving MovingOf(const FilterPath& path, Index dof, double still) {
  const Index stride = std::max<Index>(1, path.samples() / kSamples);
  Moving moving;
  std::vector<double> speeds;
  for (Index k = 0; k < path.samples(); k += stride) {
    const double v = path.states[static_cast<std::size_t>(k)].velocity[dof];
    if (std::abs(v) <= still) continue;
    moving.samples.push_back(k);
    speeds.push_back(v);
  }
  moving.speed = VectorXd::Map(speeds.data(), std::ssize(speeds));
  return moving;
}

/// The row of a joint in the mass matrix, nv x samples in which it moves.
MatrixXd MassesAt(const mjModel& plant, const FilterPath& path, Index dof,
                  const Moving& moving) {
  const DataPtr at = MakeData(plant);
  const VectorXd unit = VectorXd::Unit(plant.nv, dof);
  MatrixXd masses(plant.nv, std::ssize(moving.samples));
  for (Index i = 0; i < masses.cols(); ++i) {
    const Index k = moving.samples[static_cast<std::size_t>(i)];
    SetState(plant, path.states[static_cast<std::size_t>(k)], *at);
    mj_kinematics(&plant, at.get());
    mj_comPos(&plant, at.get());
    mj_crb(&plant, at.get());
    mj_mulM(&plant, at.get(), masses.col(i).data(), unit.data());
  }
  return masses;
}

/// What a column of ticks is as a force at a joint, where that moves.
VectorXd ForceAt(const Column& column, const MatrixXd& masses, double sample_time,
                 const Moving& moving) {
  const Index nv = masses.rows();
  VectorXd force = VectorXd::Zero(masses.cols());
  for (const auto& [state, signal] : column.states) {
    if (state < nv || state >= 2 * nv) continue;
    force += masses.row(state - nv).transpose().cwiseProduct(signal(moving.samples));
  }
  return force / sample_time;
}

/// What a force of a joint says as a curve: [dry, viscous, at every speed]. Linear in it.
class CurveOf {
 public:
  CurveOf(const Moving& moving, const VectorXd& speeds)
      : sign_(moving.speed.array().sign()),
        A_(moving.speed.size(), 3),
        speeds_(speeds) {
    // What springs or creeps before it slides is no dry friction: where it is slower than a
    // twentieth of the greatest speed, but for a twentieth of the time, says nothing of that.
    constexpr double kSlides = 0.05;
    VectorXd all = moving.speed.cwiseAbs();
    std::ranges::sort(all);
    const double least = kSlides * all[19 * all.size() / 20];
    A_ << sign_, moving.speed, VectorXd::Ones(sign_.size());
    A_.array().colwise() *= (moving.speed.cwiseAbs().array() > least).cast<double>();
    normal_.compute(A_.transpose() * A_);
    near_.resize(static_cast<std::size_t>(speeds.size()));
    for (Index i = 0; i < moving.speed.size(); ++i) {
      const double v = std::abs(moving.speed[i]);
      Index nearest = 0;
      (speeds.array().log() - std::log(v)).abs().minCoeff(&nearest);
      auto& [forwards, backwards] = near_[static_cast<std::size_t>(nearest)];
      (moving.speed[i] > 0.0 ? forwards : backwards).push_back(i);
    }
  }

  VectorXd operator()(const VectorXd& force) const {
    VectorXd values(2 + speeds_.size());
    values.head(2) = normal_.solve(A_.transpose() * force).head(2);
    for (Index s = 0; s < speeds_.size(); ++s) {
      const auto& [forwards, backwards] = near_[static_cast<std::size_t>(s)];
      double sum = 0.0;
      int sides = 0;
      // Both directions count the same: what does not change its sign is no resistance.
      for (const std::vector<Index>* side : {&forwards, &backwards}) {
        if (side->empty()) continue;
        sum += (sign_(*side).array() * force(*side).array()).mean();
        ++sides;
      }
      values[2 + s] = sides > 0 ? sum / sides : 0.0;
    }
    return values;
  }

 private:
  using Sides = std::pair<std::vector<Index>, std::vector<Index>>;

  VectorXd sign_;
  MatrixXd A_;
  Eigen::LDLT<MatrixXd> normal_;
  VectorXd speeds_;
  std::vector<Sides> near_;  // samples that are nearer to a speed than to the others
};

/// Of as many samples each.
VectorXd SpeedsOf(const Moving& moving) {
  VectorXd all = moving.speed.cwiseAbs();
  std::ranges::sort(all);
  std::vector<double> speeds;
  for (Index s = 0; s < kSpeeds; ++s) {
    const double one = all[(2 * s + 1) * all.size() / (2 * kSpeeds)];
    if (speeds.empty() || one > 1.02 * speeds.back()) speeds.push_back(one);
  }
  return VectorXd::Map(speeds.data(), std::ssize(speeds));
}

/// Those of some members.
std::vector<Index> CoordinatesIn(const std::vector<Coordinate>& coordinates,
                                 const std::set<std::size_t>& members) {
  std::vector<Index> places;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (members.contains(coordinates[i].member))
      places.push_back(static_cast<Index>(i));
  }
  return places;
}

/// Where the answer's coordinates of some members are, and with one of them moved.
struct Around {
  std::vector<OtherMachine> machines;
  std::vector<Index> coordinates;  ///< of every machine but the first
};

Around AroundOf(const AnswerData& data, const Model& model,
                const std::set<std::size_t>& members) {
  Model without;
  for (std::size_t m = 0; m < model.size(); ++m) {
    if (!members.contains(m)) without.push_back(model[m]);
  }
  Around around{{{data.With(without)}}, {}};
  const auto coordinates = CoordinatesOf(data.blocks, model);
  around.coordinates = CoordinatesIn(coordinates, members);
  for (const Index i : around.coordinates) {
    const MovedOnce moved = Moved(coordinates, model, i);
    around.machines.push_back({data.With(moved.model), moved.step});
  }
  return around;
}

/// The force of an effect at the speed of its joint; of one with a memory where it slides, by
/// what it becomes at an end of its parameters. None where it takes more than the speed.
std::optional<double> LawAt(PlacedEffect effect, double speed) {
  constexpr int kMost = 4;
  for (int k = 0; k < kMost; ++k) {
    if (effect.effect->variable() == LawVariable::kVelocity) {
      if (const auto force = effect.effect->Law(speed, effect.values)) return force;
    }
    auto simpler = effect.effect->Simpler(effect);
    if (!simpler) return std::nullopt;
    effect = *std::move(simpler);
  }
  return std::nullopt;
}

/// What members take at every speed where all of them are laws of the speed alone.
std::optional<VectorXd> ResistanceByLaws(const AnswerData& data, const Model& members,
                                         const VectorXd& speed) {
  const Changes changes = ChangesOfModel(data.blocks, members);
  if (!changes.faults.empty()) return std::nullopt;
  VectorXd force = VectorXd::Zero(speed.size());
  for (const PlacedEffect& effect : changes.effects) {
    for (Index i = 0; i < speed.size(); ++i) {
      const auto one = LawAt(effect, speed[i]);
      if (!one) return std::nullopt;
      force[i] -= *one;
    }
  }
  const mjModel& plant = data.machine.plant();
  for (const auto& [number, factor] : changes.numbers) {
    const int of =
        ElementOf(number.kind) == mjOBJ_JOINT ? plant.jnt_dofadr[number.element] : -1;
    if (number.kind == ModelParameterKind::kDamping) {
      force += (factor - 1.0) * plant.dof_damping[of] * speed;
    } else if (number.kind == ModelParameterKind::kFriction) {
      force.array() +=
          (factor - 1.0) * plant.dof_frictionloss[of] * speed.array().sign();
    } else {
      return std::nullopt;
    }
  }
  return force;
}

/// Of a slide or a hinge that a block resists; none of anything else.
std::optional<Index> ResistedDof(const mjModel& plant, const Block& block) {
  if (IsOverOwnVelocity(block)) return block.candidate->joint;
  if (block.resists.empty()) return std::nullopt;
  if (block.number && ElementOf(block.number->kind) != mjOBJ_JOINT) return std::nullopt;
  const int joint =
      block.number ? block.number->element : plant.dof_jntid[block.candidate->joint];
  const int type = plant.jnt_type[joint];
  if (type != mjJNT_SLIDE && type != mjJNT_HINGE) return std::nullopt;
  return plant.jnt_dofadr[joint];
}

/// What CurveOf says of the members, and its slopes by their coordinates.
struct Curve {
  VectorXd value;
  MatrixXd slopes;
  std::vector<Index> coordinates;
};

std::optional<Curve> CurveByLaws(const AnswerData& data, const Model& model,
                                 const std::set<std::size_t>& members,
                                 const Moving& moving, const CurveOf& curve_of) {
  const auto of_members = [&](const Model& one) -> std::optional<VectorXd> {
    Model only;
    for (const std::size_t m : members) only.push_back(one[m]);
    const auto force = ResistanceByLaws(data, only, moving.speed);
    if (!force) return std::nullopt;
    return curve_of(*force);
  };
  const auto value = of_members(model);
  if (!value) return std::nullopt;
  const auto coordinates = CoordinatesOf(data.blocks, model);
  Curve curve{*value, {}, CoordinatesIn(coordinates, members)};
  curve.slopes.resize(value->size(), std::ssize(curve.coordinates));
  for (Index i = 0; i < curve.slopes.cols(); ++i) {
    const MovedOnce moved =
        Moved(coordinates, model, curve.coordinates[static_cast<std::size_t>(i)]);
    const auto there = of_members(moved.model);
    if (!there) return std::nullopt;
    curve.slopes.col(i) = (*there - *value) / moved.step;
  }
  return curve;
}

/// By what the machine does more without them in every tick.
Curve CurveByTicks(const AnswerData& data, const ModelOnRuns& answer, Index dof,
                   const std::set<std::size_t>& members, const Moving& moving,
                   const CurveOf& curve_of) {
  const Model& model = answer.fit.model;
  const FilterPath& path = answer.seen;
  const Around around = AroundOf(data, model, members);
  const Machine machine = data.With(model);
  const std::vector<Column> columns =
      TickColumns(machine, data.run.seen, path, around.machines);
  const MatrixXd masses = MassesAt(machine.plant(), path, dof, moving);
  const auto of_column = [&](const Column& column) {
    return curve_of(ForceAt(column, masses, path.sample_time, moving));
  };
  Curve curve{of_column(columns.front()), {}, around.coordinates};
  curve.slopes.resize(curve.value.size(), std::ssize(around.coordinates));
  for (Index i = 0; i < curve.slopes.cols(); ++i) {
    curve.slopes.col(i) = -of_column(columns[static_cast<std::size_t>(i) + 1]);
  }
  return curve;
}

FoundResistance ResistanceOf(const AnswerData& data, const ModelOnRuns& answer,
                             const CoordinateErrors& errors, Index dof,
                             const std::set<std::size_t>& members) {
  FoundResistance found;
  const mjModel& plant = data.machine.plant();
  const int joint = plant.dof_jntid[dof];
  found.site = ElementName(plant, mjOBJ_JOINT, joint);
  found.is_turning = plant.jnt_type[joint] == mjJNT_HINGE;
  const FilterPath& path = answer.seen;
  const double still = StillSpeeds(plant, path.noise.reading, path.sample_time)[dof];
  const Moving moving = MovingOf(path, dof, still);
  if (moving.speed.size() < 10 * kSpeeds) return found;
  found.speeds = SpeedsOf(moving);
  const Model& model = answer.fit.model;
  const CurveOf curve_of(moving, found.speeds);
  std::optional<Curve> curve = CurveByLaws(data, model, members, moving, curve_of);
  if (!curve) {
    curve = CurveByTicks(data, answer, dof, members, moving, curve_of);
  }
  const auto& [value, slopes, coordinates] = *curve;
  const VectorXd sd = errors.sd(coordinates);
  const MatrixXd covariance =
      sd.asDiagonal() * errors.correlation(coordinates, coordinates) * sd.asDiagonal();
  const VectorXd half =
      TwoSidedNormalQuantile(0.05) *
      (slopes * covariance * slopes.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  found.dry = {value[0], value[0] - half[0], value[0] + half[0]};
  found.viscous = {value[1], value[1] - half[1], value[1] + half[1]};
  found.force = value.tail(found.speeds.size());
  found.half = half.tail(found.speeds.size());
  for (const std::size_t m : members) {
    found.members.push_back(data.blocks[model[m].block].name);
  }
  return found;
}

}  // namespace

void AddResistances(const AnswerData& data, const ModelOnRuns& answer,
                    const CoordinateErrors& errors, Discovery& discovery) {
  const Model& model = answer.fit.model;
  std::map<Index, std::set<std::size_t>> of_dof;
  for (std::size_t m = 0; m < model.size(); ++m) {
    const auto dof = ResistedDof(data.machine.plant(), data.blocks[model[m].block]);
    if (dof) of_dof[*dof].insert(m);
  }
  for (const auto& [dof, members] : of_dof) {
    // One law of one size says itself.
    if (members.size() == 1 &&
        data.blocks[model[*members.begin()].block].IsSimplest()) {
      continue;
    }
    try {
      FoundResistance found = ResistanceOf(data, answer, errors, dof, members);
      if (!found.members.empty()) discovery.resistances.push_back(std::move(found));
    } catch (const NumericalError&) {
      // Without its friction the machine does not stay with the run.
    }
  }
}

}  // namespace mjdiag
