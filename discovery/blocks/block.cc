#include "mjdiag/discovery/blocks/block.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "mjdiag/discovery/blocks/candidate_regressors.h"
#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of a bound: what is nearer is on it.
constexpr double kEnd = 1e-6;

SiteMotion At(const Machine& machine, const ObservedMotion& motion, const Site& site) {
  return {machine.plant(), machine.mechanics(), motion, site};
}

/// The columns of a trial, each amplitude its own, or all of one.
std::vector<Column> ColumnsOf(const CandidateRegressor& trial, Index sensor) {
  const bool of_reading = trial.entry.size() == 0;
  std::vector<Column> columns;
  for (Index a = 0; a < trial.signals.cols(); ++a) {
    if (columns.empty() || !trial.summed) columns.emplace_back();
    Column& column = columns.back();
    if (of_reading) {
      column.readings.emplace_back(sensor, trial.signals.col(a));
      continue;
    }
    for (Index dof = 0; dof < trial.entry.rows(); ++dof) {
      if (trial.entry(dof, a) == 0.0) continue;
      column.forces.emplace_back(dof, trial.entry(dof, a) * trial.signals.col(a));
    }
  }
  return columns;
}

// A regression may take sizes that far, in standard deviations, as easily as any: what they
// cost comes on top (SizePrice).
constexpr double kWide = 3.0;

double Rms(const VectorXd& signal) {
  return std::sqrt(signal.squaredNorm() / static_cast<double>(signal.size()));
}

/// How large amplitudes are expected to be: so large that the size of the law is what it
/// usually is; where any is as good, as large as what drives the joint or as the reading's
/// own span.
VectorXd SpreadOf(const Candidate& candidate, const CandidateRegressor& trial,
                  const Scales& scales, Index amplitudes,
                  const std::vector<Column>& columns, const VectorXd& span) {
  VectorXd sd(amplitudes);
  const auto sized = std::ranges::find_if(candidate.parameters, [](const auto& one) {
    return one.role == Role::kAmplitude || one.role == Role::kFactor ||
           one.role == Role::kTime;
  });
  for (Index a = 0; a < amplitudes; ++a) {
    const Column& column = columns[static_cast<std::size_t>(a)];
    double largest = 0.0;
    double usual = scales.force;
    for (const auto& [dof, signal] : column.forces) {
      largest = std::max(largest, Rms(signal));
    }
    for (const auto& [sensor, signal] : column.readings) {
      largest = std::max(largest, Rms(signal));
      usual = span[sensor];
    }
    sd[a] = largest > 0.0 ? usual / largest : 1.0;
    if (sized == candidate.parameters.end()) continue;
    const auto place = sized - candidate.parameters.begin();
    if (!(sized->spread > 0.0) || !std::isfinite(sized->spread)) continue;
    const double small = 1e-3 * sd[a];
    RegressorValues values = trial.values(small * VectorXd::Unit(amplitudes, a));
    if (!values) values = trial.values(-small * VectorXd::Unit(amplitudes, a));
    if (!values) continue;
    const double rate = std::abs((*values)[place] - sized->nothing) / small;
    if (rate > 0.0) sd[a] = std::min(sd[a], kWide * sized->spread / rate);
  }
  return sd;
}

std::vector<CandidateRegressor> RegressorsOf(const Machine& machine,
                                             const Candidate& candidate,
                                             const ObservedMotion& motion) {
  if (!IsCurve(candidate)) return MakeCandidateRegressors(machine, candidate, motion);
  const Site site{candidate.site, candidate.joint, candidate.channel};
  return {RegressorOfCurve(At(machine, motion, site), candidate)};
}

void OfCandidate(const Machine& machine, const BlockMotion& along, std::size_t place,
                 Block& block, const std::function<void(Variation&&)>& take) {
  const BlockScales scales = ScalesOf(machine, along, block);
  std::size_t shape = 0;
  Index count = 0;
  for (const CandidateRegressor& trial :
       RegressorsOf(machine, *block.candidate, along.motion)) {
    Variation variation = VariationOf(place, block, scales, trial, shape++);
    if (variation.columns.empty()) continue;
    ++count;
    take(std::move(variation));
  }
  block.price = PriceOf(block, count);
}

void OfNumber(const Machine& machine, const BlockMotion& along, std::size_t place,
              Block& block, const std::function<void(Variation&&)>& take) {
  const ModelParameter& number = *block.number;
  const MatrixXd force = NumberForce(
      machine.plant(), machine.actuator_addresses(), number, along.motion,
      StillSpeeds(machine.plant(), along.reading_noise, along.motion.sample_time));
  // How joints that nothing tells are accelerated within a tick is known too badly to say what a
  // mass does there: a fit asks the machine.
  const bool is_of_bodies = ElementOf(number.kind) == mjOBJ_BODY;
  const auto is_told = [&](Index dof) {
    return std::ranges::find(along.told, dof) != along.told.end();
  };
  Variation variation{place, 0, {{}}, {}, {}, {}};
  for (Index dof = 0; dof < force.cols(); ++dof) {
    if (force.col(dof).isZero(0.0) || (is_of_bodies && !is_told(dof))) continue;
    variation.columns.front().forces.emplace_back(dof, force.col(dof));
  }
  block.price = PriceOf(block, 1);
  if (variation.columns.front().forces.empty()) return;
  variation.sd = VectorXd::Constant(1, kWide * block.doubt);
  variation.values = [](const Amplitudes& a) -> RegressorValues {
    return VectorXd(a.array().exp());
  };
  take(std::move(variation));
}

bool Resists(Kind kind) {
  return kind == Kind::kDryFriction || kind == Kind::kLoadFriction ||
         kind == Kind::kViscousFriction;
}

/// Resistances of a joint are one curve over its velocity each, however it is called.
std::string GroupOf(Kind kind, const std::string& name) {
  const std::string site = name.substr(name.find('@') + 1);
  switch (kind) {
    case Kind::kUnknownForce:
      return "curve@" + site;
    case Kind::kDryFriction:
    case Kind::kLoadFriction:
      return "dry friction@" + site;
    case Kind::kViscousFriction:
      return "viscous friction@" + site;
    default:
      return name;
  }
}

}  // namespace

std::vector<ModelParameter> NumbersOf(const mjModel& plant) {
  std::vector<ModelParameter> numbers = ModelParameters(plant);
  std::ranges::copy(CentreNumbers(plant), std::back_inserter(numbers));
  return numbers;
}

std::vector<Block> BlocksOf(const Machine& machine,
                            const std::vector<Candidate>& candidates,
                            const std::vector<ModelParameter>& numbers) {
  std::vector<Block> blocks;
  std::vector<ModelParameter> aliased;
  for (const Candidate& candidate : candidates) {
    const std::string name = CandidateName(candidate);
    const auto number = NumberAt(*candidate.effect, machine.plant(), candidate.site);
    // A law that changes a number that is in doubt, or that is known where others are not, is
    // said as that number; a fault parameter has a name of its own, and friction is found as
    // what it is where the plant has none.
    const bool is_number = number && !candidate.effect->IsFault() &&
                           candidate.effect->family() != Family::kFriction;
    if (is_number && !numbers.empty()) continue;
    const bool repeats = PeriodPlace(candidate) < std::ssize(candidate.parameters);
    blocks.push_back({.name = name,
                      .candidate = candidate,
                      .number = std::nullopt,
                      .group = repeats ? "" : GroupOf(candidate.effect->kind(), name)});
    if (blocks.back().IsResistance()) blocks.back().resists = candidate.site;
    if (candidate.effect->IsFault() && number && Resists(KindOf(number->kind))) {
      blocks.back().resists =
          ElementName(machine.plant(), ElementOf(number->kind), number->element);
    }
    // A factor of a number is known as well as the number. Sizes follow from the machine's
    // own scales: nine times what is usual would drive it in the place of its motors.
    for (FitParameter& parameter : blocks.back().candidate->parameters) {
      if (parameter.role == Role::kFactor) {
        if (number) parameter.spread = DoubtOf(machine.plant(), *number);
        const double farthest =
            std::min(kMostTimes, std::exp(kFarthest * parameter.spread));
        parameter.lower = std::max(parameter.lower, 1.0 / farthest);
        parameter.upper = std::min(parameter.upper, farthest);
      } else if (parameter.role == Role::kAmplitude) {
        const double farthest = kFarthest * parameter.spread;
        parameter.lower = std::max(parameter.lower, parameter.nothing - farthest);
        parameter.upper = std::min(parameter.upper, parameter.nothing + farthest);
      }
    }
    if (number) aliased.push_back(*number);
  }
  for (const ModelParameter& number : numbers) {
    if (std::ranges::find(aliased, number) != aliased.end()) continue;
    const std::string name = ModelParameterName(machine.plant(), number);
    blocks.push_back({.name = name,
                      .candidate = std::nullopt,
                      .number = number,
                      .doubt = DoubtOf(machine.plant(), number),
                      .group = GroupOf(KindOf(number.kind), name)});
    if (Resists(KindOf(number.kind))) {
      blocks.back().resists =
          ElementName(machine.plant(), ElementOf(number.kind), number.element);
    }
  }
  // Of one shape: those that are taken in the place of others before anything has looked at
  // their shapes cost something, too.
  for (Block& block : blocks) block.price = PriceOf(block, 1);
  return blocks;
}

bool Block::HasShape() const {
  return candidate && std::ranges::any_of(candidate->parameters, [](const auto& one) {
           return IsShape(one.role);
         });
}

bool Block::IsResistance() const {
  if (!candidate || candidate->effect->family() != Family::kFriction) return false;
  return Resists(candidate->effect->kind());
}

bool Block::IsDryFriction() const {
  return IsResistance() && candidate->effect->kind() == Kind::kDryFriction;
}

bool Block::GrowsWithLoad() const {
  return IsResistance() && candidate->effect->kind() == Kind::kLoadFriction;
}

bool Block::GivesWay() const {
  return candidate && candidate->effect.get() == &YieldingFriction();
}

bool Block::Springs() const {
  return candidate && candidate->effect.get() == &PreslidingHysteresis();
}

bool Block::BreaksAway() const {
  return candidate && candidate->effect.get() == &StribeckFriction();
}

bool Block::IsSmoothFriction() const {
  return IsDryFriction() && candidate->parameters.size() == 2 &&
         candidate->parameters.back().role == Role::kVelocity;
}

bool Block::IsOfDrive() const {
  return candidate ? candidate->effect->site() == SiteKind::kActuator
                   : IsDrive(number->kind);
}

bool Block::IsInertia() const {
  if (candidate) return candidate->effect->kind() == Kind::kInertia;
  return number->kind == ModelParameterKind::kMass ||
         number->kind == ModelParameterKind::kInertia ||
         number->kind == ModelParameterKind::kArmature;
}

bool Block::IsWave() const {
  return candidate && candidate->effect->Find(Role::kPhase).has_value();
}

bool Block::IsSimplest() const {
  if (!candidate) return true;
  return candidate->parameters.size() == 1 &&
         candidate->effect->kind() != Kind::kLoadFriction;
}

bool HasActiveBound(const Block& block, const Eigen::VectorXd& values) {
  return !block.candidate &&
         std::abs(std::log(values[0])) >= (1.0 - kEnd) * kFarthest * block.doubt;
}

bool IsAllowed(const Block& block, const RegressorValues& values) {
  if (!values || !values->allFinite()) return false;
  if (!block.candidate) {
    return std::abs(std::log((*values)[0])) <= (1.0 + kEnd) * kFarthest * block.doubt;
  }
  for (Index i = 0; i < values->size(); ++i) {
    const FitParameter& parameter =
        block.candidate->parameters[static_cast<std::size_t>(i)];
    if (!parameter.IsSeen((*values)[i])) return false;
    if (IsShape(parameter.role)) continue;
    if (std::abs((*values)[i] - parameter.nothing) < parameter.least_size) return false;
    if ((*values)[i] < parameter.lower || (*values)[i] > parameter.upper) return false;
  }
  return true;
}

double SizePrice(double x) { return 3.0 * std::log1p(x * x / 3.0); }

double SizePrice(const Block& block, const VectorXd& values) {
  if (block.number) return SizePrice(std::log(values[0]) / block.doubt);
  double sum = 0.0;
  if (IsCurve(*block.candidate)) {
    const double spread = block.candidate->parameters.front().spread;
    const VectorXd white = WhiteningOfKnots(*block.candidate) * (values / spread);
    for (const double one : white) sum += SizePrice(one);
    return sum;
  }
  for (Index i = 0; i < values.size(); ++i) {
    const FitParameter& parameter =
        block.candidate->parameters[static_cast<std::size_t>(i)];
    if (!std::isfinite(parameter.spread) || !(parameter.spread > 0.0)) continue;
    if (parameter.role == Role::kFactor && values[i] > 0.0) {
      sum += SizePrice(std::log(values[i]) / parameter.spread);
    } else if (!IsShape(parameter.role)) {
      sum += SizePrice((values[i] - parameter.nothing) / parameter.spread);
    }
  }
  return sum;
}

double PriceOf(const Block& block, Index shapes) {
  // A number that is known to some percent is off; by how much, SizePrice asks.
  const double probability =
      block.candidate ? kMissing * block.candidate->effect->odds() : 1.0;
  return kClaim - 2.0 * std::log(probability) +
         2.0 * std::log(std::max(1.0, static_cast<double>(shapes)));
}

std::optional<ParameterScan> ParameterScanOf(const Machine& machine,
                                             const BlockMotion& along,
                                             const Block& block) {
  if (!block.candidate) return std::nullopt;
  return MakeParameterScan(machine, *block.candidate, along.motion, along.duration);
}

BlockScales ScalesOf(const Machine& machine, const BlockMotion& along,
                     const Block& block) {
  const Candidate& candidate = *block.candidate;
  const Site site{candidate.site, candidate.joint, candidate.channel};
  const ObservedMotion& motion = along.motion;
  return {ScalesOf(At(machine, motion, site)),
          motion.outputs.rowwise().maxCoeff() - motion.outputs.rowwise().minCoeff()};
}

Variation VariationOf(std::size_t place, const Block& block, const BlockScales& scales,
                      const CandidateRegressor& trial, std::size_t shape) {
  const Candidate& candidate = *block.candidate;
  Variation variation{place, shape,       ColumnsOf(trial, candidate.channel),
                      {},    trial.least, trial.values};
  for (const Column& column : variation.columns) {
    if (!column.forces.empty() || !column.readings.empty()) continue;
    variation.columns.clear();
    return variation;
  }
  const auto amplitudes = std::ssize(variation.columns);
  variation.sd = SpreadOf(candidate, trial, scales.site, trial.summed ? 1 : amplitudes,
                          variation.columns, scales.spans);
  return variation;
}

void ForEachVariation(const Machine& machine, const BlockMotion& along,
                      std::size_t place, Block& block,
                      const std::function<void(Variation&&)>& take) {
  if (block.candidate) {
    OfCandidate(machine, along, place, block, take);
  } else {
    OfNumber(machine, along, place, block, take);
  }
}

}  // namespace mjdiag
