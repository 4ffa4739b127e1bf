#include "mjdiag/discovery/fitting/scale_gauge.h"

#include <Eigen/QR>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/tendon_moment.h"

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
        // What is behind it is as heavy as all else, and the gear is the same.
        if (plant_.actuator_biastype[number.element] == mjBIAS_AFFINE) {
          return std::nullopt;
        }
        [[fallthrough]];
      case PlantNumberKind::kGain:
      case PlantNumberKind::kKp:
      case PlantNumberKind::kKv: {
        const auto& motors = machine.actuator_addresses();
        const auto at = std::ranges::find(motors, number.element);
        if (at == motors.end()) return std::nullopt;
        return First(machine.linear().Gamma.col(at - motors.begin()));
      }
      case PlantNumberKind::kCentreX:
      case PlantNumberKind::kCentreY:
      case PlantNumberKind::kCentreZ:
      case PlantNumberKind::kRef:
        return std::nullopt;  // where it is, no matter how heavy
      case PlantNumberKind::kTendonStiffness:
      case PlantNumberKind::kTendonDamping:
      case PlantNumberKind::kTendonFriction:
        // As it is drawn.
        return First(TendonMoments(plant_, plant_.qpos0).col(number.element));
      case PlantNumberKind::kStiffness:
      case PlantNumberKind::kDamping:
      case PlantNumberKind::kFriction:
      case PlantNumberKind::kArmature:
        break;
    }
    return Of(plant_.jnt_dofadr[number.element]);
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

/// Of a number of a joint or a body as the plant has it; none of others.
std::optional<double> ValueOf(const mjModel& plant, const PlantNumber& number) {
  const auto dof = [&] { return plant.jnt_dofadr[number.element]; };
  switch (number.kind) {
    case PlantNumberKind::kMass:
      return plant.body_mass[number.element];
    case PlantNumberKind::kStiffness:
      return plant.jnt_stiffness[number.element];
    case PlantNumberKind::kDamping:
      return plant.dof_damping[dof()];
    case PlantNumberKind::kFriction:
      return plant.dof_frictionloss[dof()];
    case PlantNumberKind::kArmature:
      return plant.dof_armature[dof()];
    default:
      return std::nullopt;
  }
}

/// n and v of a parameter; of one that adds to a number, or scales it, that number counts
/// with it. None where they cannot be told.
std::optional<std::pair<double, double>> LawOf(const mjModel& plant,
                                               const Candidate& candidate,
                                               const EffectParameter& parameter) {
  const Effect& effect = *candidate.effect;
  const int exponent = ForceExponent(parameter.unit);
  const auto number = NumberAt(effect, plant, candidate.site);
  if (!number) return std::pair(static_cast<double>(exponent), 0.0);
  if (parameter.role == Role::kFactor) return std::pair(1.0, 0.0);
  if (exponent == 0) return std::pair(0.0, 0.0);
  const auto value = ValueOf(plant, *number);
  if (!value) return std::nullopt;
  return std::pair(1.0, *value);
}

ScaleGauge Nothing(Index size) {
  return {VectorXd::Zero(size), VectorXd::Zero(size), VectorXd::Zero(size)};
}

/// A fault parameter and the numbers that it scales, if all of them are in doubt, are two
/// ways to say the same.
std::vector<ScaleGauge> FaultGauges(const DiscoveryProblem& problem,
                                    const std::vector<Candidate>& candidates,
                                    const std::vector<FittedCause>& causes,
                                    Index size) {
  const std::vector<FaultParameter> faults = FaultParameters(problem.machine().plant());
  const std::vector<DoubtedNumber>& numbers = problem.numbers();
  std::vector<ScaleGauge> gauges;
  auto next = static_cast<Index>(numbers.size());
  for (const FittedCause& cause : causes) {
    const Candidate& candidate = candidates[cause.candidate];
    const Index place = next;
    next += std::ssize(candidate.parameters);
    if (!candidate.effect->IsFault()) continue;
    const auto fault =
        std::ranges::find(faults, candidate.effect->name(), &FaultParameter::name);
    if (fault == faults.end()) continue;
    ScaleGauge gauge = Nothing(size);
    gauge.exponent[place] = -1.0;
    std::size_t in_doubt = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i].is_lateness || numbers[i].number.kind != fault->kind) continue;
      if (!std::ranges::count(fault->elements, numbers[i].number.element)) continue;
      gauge.shift[static_cast<Index>(i)] = 1.0 / numbers[i].spread;
      ++in_doubt;
    }
    if (in_doubt == fault->elements.size()) gauges.push_back(std::move(gauge));
  }
  return gauges;
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

VectorXd ScaleGauge::Along(const VectorXd& theta) const {
  return shift + exponent.cwiseProduct(theta + offset);
}

VectorXd ScaleGauge::Moved(const VectorXd& theta, double t) const {
  const VectorXd grown = (t * exponent).array().exp().matrix();
  return t * shift + grown.cwiseProduct(theta + offset) - offset;
}

FittedModel HandedOver(const DiscoveryProblem& problem,
                       const std::vector<Candidate>& candidates,
                       const FittedModel& model, std::size_t cause) {
  FittedModel without{Without(model.causes, {cause}), model.numbers,
                      model.prior_weight};
  const FittedCause& fitted = model.causes[cause];
  const Candidate& candidate = candidates[fitted.candidate];
  const std::vector<DoubtedNumber>& numbers = problem.numbers();
  if (fitted.value.size() != 1 || without.numbers.size() != std::ssize(numbers)) {
    return without;
  }
  const auto take = [&](std::size_t i, double from, double factor) {
    if (!(factor > 0.0)) return;
    without.numbers[static_cast<Index>(i)] =
        std::clamp(from + std::log(factor) / numbers[i].spread, numbers[i].Least(),
                   numbers[i].Most());
  };
  if (candidate.effect->IsFault()) {
    const auto gauges = FaultGauges(problem, candidates, {fitted},
                                    std::ssize(numbers) + fitted.value.size());
    if (gauges.empty()) return without;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto place = static_cast<Index>(i);
      if (gauges.front().shift[place] == 0.0) continue;
      take(i, without.numbers[place], fitted.value[0]);
    }
    return without;
  }
  const mjModel& plant = problem.machine().plant();
  const auto number = NumberAt(*candidate.effect, plant, candidate.site);
  if (!number) return without;
  const EffectParameter& parameter = candidate.effect->parameters().front();
  const auto own = ValueOf(plant, *number);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i].is_lateness || numbers[i].number != *number) continue;
    // Beside the cause the number was as the plant says.
    if (parameter.role == Role::kFactor) {
      take(i, 0.0, fitted.value[0]);
    } else if (own && *own > 0.0) {
      take(i, 0.0, 1.0 + fitted.value[0] / *own);
    }
  }
  return without;
}

std::vector<ScaleGauge> ScaleGauges(const DiscoveryProblem& problem,
                                    const std::vector<Candidate>& candidates,
                                    const std::vector<FittedCause>& causes) {
  const Machine& machine = problem.machine();
  const JoinedParts parts(machine);
  const std::vector<bool> stood_for = problem.StoodFor(ChangesOf(candidates, causes));
  const auto numbers = static_cast<Index>(problem.numbers().size());
  const Index size = numbers + Flatten(causes).size();
  std::map<Index, ScaleGauge> of_parts;
  for (Index i = 0; i < numbers; ++i) {
    const DoubtedNumber& doubted = problem.numbers()[static_cast<std::size_t>(i)];
    if (doubted.is_lateness || stood_for[static_cast<std::size_t>(i)]) continue;
    const auto part = parts.Of(doubted.number, machine);
    if (!part) continue;
    of_parts.try_emplace(*part, Nothing(size)).first->second.shift[i] =
        1.0 / doubted.spread;
  }
  Index next = numbers;
  for (const FittedCause& cause : causes) {
    const Candidate& candidate = candidates[cause.candidate];
    const Index part = parts.Of(candidate.joint);
    const auto& known = candidate.effect->parameters();
    for (std::size_t k = 0; k < candidate.parameters.size(); ++k, ++next) {
      const std::size_t place = static_cast<std::size_t>(candidate.chosen.size()) + k;
      const auto found = of_parts.find(part);
      if (found == of_parts.end() || place >= known.size()) continue;
      const auto law = LawOf(machine.plant(), candidate, known[place]);
      if (law) {
        found->second.exponent[next] = law->first;
        found->second.offset[next] = law->second;
      } else {
        of_parts.erase(found);
      }
    }
  }
  std::vector<ScaleGauge> gauges;
  for (auto& [part, gauge] : of_parts) gauges.push_back(std::move(gauge));
  for (ScaleGauge& gauge : FaultGauges(problem, candidates, causes, size)) {
    gauges.push_back(std::move(gauge));
  }
  return gauges;
}

std::vector<ScaleGauge> Untold(std::vector<ScaleGauge> gauges, const VectorXd& theta,
                               const MatrixXd& jacobian) {
  constexpr double kOff = 0.05;  // of a first order
  const VectorXd squares = jacobian.colwise().squaredNorm();
  std::erase_if(gauges, [&](const ScaleGauge& gauge) {
    const VectorXd along = gauge.Along(theta);
    const double size = squares.dot(along.cwiseAbs2());
    return !(size > 0.0) || (jacobian * along).squaredNorm() > kOff * kOff * size;
  });
  return gauges;
}

void RemoveGauges(const std::vector<ScaleGauge>& gauges, const VectorXd& theta,
                  MatrixXd& jacobian) {
  if (gauges.empty()) return;
  MatrixXd G(theta.size(), std::ssize(gauges));
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    G.col(static_cast<Index>(i)) = gauges[i].Along(theta);
  }
  const MatrixXd weighed =
      jacobian.colwise().squaredNorm().transpose().asDiagonal() * G;
  const MatrixXd inverse =
      (G.transpose() * weighed).completeOrthogonalDecomposition().pseudoInverse();
  jacobian -= (jacobian * G) * inverse * weighed.transpose();
}

VectorXd KeptToWhatIsKnown(const std::vector<ScaleGauge>& gauges, VectorXd theta,
                           const std::vector<FitParameter>& parameters) {
  constexpr int kSweeps = 4;
  constexpr int kSteps = 20;
  const auto is_within = [&](const VectorXd& at) {
    for (Index i = 0; i < at.size(); ++i) {
      const FitParameter& parameter = parameters[static_cast<std::size_t>(i)];
      if (at[i] < parameter.lower || at[i] > parameter.upper) return false;
    }
    return true;
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const ScaleGauge& gauge : gauges) {
      // Gauss and Newton in t, of residuals of which each grows or falls steadily.
      double t = 0.0;
      for (int step = 0; step < kSteps; ++step) {
        const VectorXd at = gauge.Moved(theta, t);
        const VectorXd along = gauge.Along(at);
        double slope = 0.0;
        double curvature = 0.0;
        for (Index i = 0; i < at.size(); ++i) {
          const FitParameter& parameter = parameters[static_cast<std::size_t>(i)];
          if (!std::isfinite(parameter.spread)) continue;
          const double d = along[i] / parameter.spread;
          slope += d * (at[i] - parameter.nothing) / parameter.spread;
          curvature += d * d;
        }
        if (!(curvature > 0.0)) break;
        t -= slope / curvature;
      }
      const VectorXd moved = gauge.Moved(theta, t);
      if (moved.allFinite() && is_within(moved)) theta = moved;
    }
  }
  return theta;
}

}  // namespace mjdiag
