#include "mjdiag/discovery/fitting/scale_gauge.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <numeric>
#include <optional>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Coordinates of a plant in parts that nothing joins.
class JoinedParts {
 public:
  explicit JoinedParts(const Machine& machine)
      : plant_(machine.plant()), root_(static_cast<std::size_t>(plant_.nv)) {
    std::iota(root_.begin(), root_.end(), 0);
    const MechanicalModel& linear = machine.linear();
    for (const MatrixXd* of : {&linear.M, &linear.K, &linear.D}) {
      const VectorXd size = of->diagonal().cwiseAbs().cwiseSqrt();
      for (Index i = 0; i < of->rows(); ++i) {
        for (Index j = 0; j < i; ++j) {
          if (std::abs((*of)(i, j)) > 1e-12 * size[i] * size[j]) Join(i, j);
        }
      }
    }
    for (Index u = 0; u < linear.Gamma.cols(); ++u) JoinAll(linear.Gamma.col(u));
    // A body adds to the inertia of all joints that carry it.
    for (int body = 1; body < plant_.nbody; ++body) JoinAll(CarriersOf(body));
  }

  Index Of(Index coordinate) const {
    while (root_[static_cast<std::size_t>(coordinate)] != coordinate) {
      coordinate = root_[static_cast<std::size_t>(coordinate)];
    }
    return coordinate;
  }
  /// None of a body that nothing carries.
  std::optional<Index> Of(const PlantNumber& number, const Machine& machine) const {
    switch (number.kind) {
      case PlantNumberKind::kMass:
      case PlantNumberKind::kInertia:
        return First(CarriersOf(number.element));
      case PlantNumberKind::kGear:
      case PlantNumberKind::kGain: {
        const auto& motors = machine.actuator_addresses();
        const auto at = std::ranges::find(motors, number.element);
        if (at == motors.end()) return std::nullopt;
        return First(machine.linear().Gamma.col(at - motors.begin()));
      }
      default:
        return Of(plant_.jnt_dofadr[number.element]);
    }
  }

 private:
  VectorXd CarriersOf(int body) const {
    VectorXd carries = VectorXd::Zero(plant_.nv);
    for (int b = body; b > 0; b = plant_.body_parentid[b]) {
      for (int i = 0; i < plant_.body_dofnum[b]; ++i) {
        carries[plant_.body_dofadr[b] + i] = 1.0;
      }
    }
    return carries;
  }
  std::optional<Index> First(const VectorXd& of) const {
    for (Index i = 0; i < of.size(); ++i) {
      if (of[i] != 0.0) return Of(i);
    }
    return std::nullopt;
  }
  void JoinAll(const VectorXd& of) {
    const auto first = First(of);
    for (Index i = 0; i < of.size(); ++i) {
      if (of[i] != 0.0) Join(*first, i);
    }
  }
  void Join(Index a, Index b) { root_[static_cast<std::size_t>(Of(a))] = Of(b); }

  const mjModel& plant_;
  std::vector<Index> root_;
};

/// Of a number of a joint as the plant has it; none of others.
std::optional<double> ValueOf(const mjModel& plant, const PlantNumber& number) {
  const int dof = plant.jnt_dofadr[number.element];
  switch (number.kind) {
    case PlantNumberKind::kStiffness:
      return plant.jnt_stiffness[number.element];
    case PlantNumberKind::kDamping:
      return plant.dof_damping[dof];
    case PlantNumberKind::kFriction:
      return plant.dof_frictionloss[dof];
    case PlantNumberKind::kArmature:
      return plant.dof_armature[dof];
    default:
      return std::nullopt;
  }
}

/// d theta / d ln s of a parameter; of one that adds to a number, or scales it, that number
/// counts with it. None where it cannot be told.
std::optional<double> SlopeOf(const mjModel& plant, const Effect& effect,
                              const std::string& site, const EffectParameter& parameter,
                              double theta) {
  const int element = mj_name2id(&plant, effect.element(), site.c_str());
  const auto number = element < 0 ? std::nullopt : effect.Number(plant, element);
  if (!number) return ForceExponent(parameter.unit) * theta;
  if (parameter.role == Role::kFactor) return theta;
  if (ForceExponent(parameter.unit) == 0) return 0.0;
  if (number->kind == PlantNumberKind::kMass) {
    return theta + plant.body_mass[number->element];
  }
  const auto value = ValueOf(plant, *number);
  if (!value) return std::nullopt;
  return theta + *value;
}

}  // namespace

int ForceExponent(const std::string& unit) {
  int exponent = 0;
  int sign = 1;
  std::size_t i = 0;
  while (i < unit.size()) {
    if (!std::isalnum(static_cast<unsigned char>(unit[i]))) {
      sign = unit[i] == '/' ? -1 : 1;
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < unit.size() && std::isalnum(static_cast<unsigned char>(unit[end]))) {
      ++end;
    }
    const std::string factor = unit.substr(i, end - i);
    if (factor == "N" || factor == "kg") exponent += sign;
    i = end;
  }
  return exponent;
}

MatrixXd ScaleGauges(const DiscoveryProblem& problem,
                     const std::vector<Candidate>& candidates,
                     const std::vector<FittedCause>& causes, const VectorXd& theta) {
  const Machine& machine = problem.machine();
  const JoinedParts parts(machine);
  const std::vector<bool> stood_for = problem.StoodFor(ChangesOf(candidates, causes));
  std::map<Index, VectorXd> gauges;
  const auto of = [&](Index part) -> VectorXd& {
    return gauges.try_emplace(part, VectorXd::Zero(theta.size())).first->second;
  };
  const auto numbers = static_cast<Index>(problem.numbers().size());
  for (Index i = 0; i < numbers; ++i) {
    const DoubtedNumber& doubted = problem.numbers()[static_cast<std::size_t>(i)];
    if (doubted.is_lateness || stood_for[static_cast<std::size_t>(i)]) continue;
    if (const auto part = parts.Of(doubted.number, machine)) {
      of(*part)[i] = 1.0 / doubted.spread;
    }
  }
  Index next = numbers;
  for (const FittedCause& cause : causes) {
    const Candidate& candidate = candidates[cause.candidate];
    const Index part = parts.Of(candidate.joint);
    const auto& known = candidate.effect->parameters();
    for (std::size_t k = 0; k < candidate.parameters.size(); ++k, ++next) {
      const std::size_t place = static_cast<std::size_t>(candidate.chosen.size()) + k;
      const auto found = gauges.find(part);
      if (found == gauges.end() || place >= known.size()) continue;
      const auto slope = SlopeOf(machine.plant(), *candidate.effect, candidate.site,
                                 known[place], theta[next]);
      if (slope) {
        found->second[next] = *slope;
      } else {
        gauges.erase(found);
      }
    }
  }
  MatrixXd columns(theta.size(), std::ssize(gauges));
  Index column = 0;
  for (const auto& [part, gauge] : gauges) columns.col(column++) = gauge;
  return columns;
}

void RemoveGauges(const MatrixXd& gauges, MatrixXd& jacobian) {
  constexpr double kOff = 0.05;  // of a first order
  const VectorXd squares = jacobian.colwise().squaredNorm();
  for (Index i = 0; i < gauges.cols(); ++i) {
    const auto gauge = gauges.col(i);
    const VectorXd weight = squares.cwiseProduct(gauge);
    const double size = gauge.dot(weight);
    const VectorXd says = jacobian * gauge;
    if (!(size > 0.0) || says.squaredNorm() > kOff * kOff * size) continue;
    jacobian.noalias() -= says * (weight / size).transpose();
  }
}

}  // namespace mjdiag
