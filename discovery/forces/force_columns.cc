#include "mjdiag/discovery/forces/force_columns.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "mjdiag/comparison/missing_force.h"
#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whether its one size multiplies what a drive does.
bool ScalesDrive(const Candidate& candidate) {
  return candidate.effect->site() == SiteKind::kActuator &&
         candidate.parameters.size() == 1 &&
         candidate.parameters.front().role == Role::kFactor;
}

/// Forces of masses are those of the measured acceleration: all masses and all drives twice
/// as large, and what is left the same in units of the input.
ObservedMotion AsMeasured(ObservedMotion motion) {
  motion.own_acceleration = motion.acceleration;
  return motion;
}

/// The forces of laws are low-passed, and those of drives with what drove them as it was
/// measured: what is filtered twice is not what a drive lacks.
ObservedMotion OfLaws(ObservedMotion motion, const FilteredRun& filtered) {
  motion.inputs = filtered.inputs;
  return motion;
}

}  // namespace

ForceColumns::ForceColumns(const DiscoveryProblem& problem, const FilteredRun& filtered,
                           const ForceBalance& balance)
    : problem_(problem),
      filtered_(filtered),
      motion_(AsMeasured(balance.motion)),
      of_laws_(OfLaws(motion_, filtered)),
      missing_rms_(MissingRms(
          filtered, MissingWithoutFriction(problem.machine(), filtered, balance))),
      rows_(RowsAlong(filtered, ForcedDofs(problem.machine()), problem.train())),
      missing_(RowsOf(rows_, balance.missing)) {
  Silence(balance.sticks, rows_);
}

/// By a factor, samples x nv.
MatrixXd ForceColumns::ForceOf(const DoubtedNumber& doubted) const {
  const Machine& machine = problem_.machine();
  if (doubted.is_lateness) {
    return LatenessForce(machine.plant(), machine.linear().Gamma, motion_);
  }
  MatrixXd force = NumberForce(machine.plant(), machine.actuator_addresses(),
                               doubted.number, motion_, problem_.StillSpeed());
  if (IsFriction(doubted.number.kind)) {
    // It jumps, and readings do not.
    for (Index dof = 0; dof < force.cols(); ++dof) {
      if (force.col(dof).isZero(0.0)) continue;
      force.col(dof) = LowPassed(filtered_, force.col(dof));
    }
  }
  return force;
}

/// Numbers as everything else has them, z in logarithms, for those of a balance of forces,
/// which is linear in most.
VectorXd ForceColumns::NumbersOf(const VectorXd& z) const {
  constexpr double kLeastFactor = 0.1;
  VectorXd numbers = z;
  for (Index i = 0; i < z.size(); ++i) {
    const DoubtedNumber& doubted = problem_.numbers()[static_cast<std::size_t>(i)];
    if (!doubted.is_lateness && !IsAdditive(doubted.number.kind)) {
      numbers[i] = std::log(std::max(1.0 + doubted.spread * z[i], kLeastFactor)) /
                   doubted.spread;
    }
    numbers[i] = std::clamp(numbers[i], doubted.Least(), doubted.Most());
  }
  return numbers;
}

void ForceColumns::SilenceAt(const VectorXd& z, ForceProblem& forces) const {
  const Changes changes = problem_.WithNumbers({}, NumbersOf(z));
  problem_.work()->Add(problem_.RunWork());
  Silence(BalanceForces(problem_.machine(), changes, filtered_).sticks, forces.rows);
}

ForceProblem ForceColumns::NumbersAlone() const {
  const Machine& machine = problem_.machine();
  const auto& numbers = problem_.numbers();
  ForceProblem forces{rows_, missing_,
                      MatrixXd::Zero(rows_.rows(), std::ssize(numbers)),
                      VectorXd::Zero(std::ssize(numbers))};
  problem_.work()->Add(problem_.RunWork() / machine.rates().substeps *
                       static_cast<double>(numbers.size()));
  ParallelForAll(static_cast<int>(numbers.size()), [&](int number) {
    const DoubtedNumber& doubted = numbers[static_cast<std::size_t>(number)];
    forces.numbers.col(number) =
        doubted.spread * RowsOf(rows_, ForceOf(doubted).transpose());
    if (!doubted.is_lateness && IsDrive(doubted.number.kind)) {
      forces.drives[number] = doubted.spread;
    }
  });
  return forces;
}

/// What a drive does along the stroke, late, or up to a limit, is made of inputs that were
/// measured with what no model explains in them: a drive that does less, or later, leaves
/// less. A law that goes by the load takes it from that input, too: where what is missing,
/// and friction that the plant has already, is much of it, it explains itself; up to a tenth
/// of its power it bends the values by no more than that. A shaking from outside that is as slow as the band is told from what a motion
/// lacks by nothing but chance.
bool ForceColumns::IsTold(const Candidate& candidate) const {
  constexpr double kMuch = 0.1;
  const Effect& effect = *candidate.effect;
  if (effect.kind() == Kind::kVibration) return false;
  if (effect.site() == SiteKind::kActuator) {
    return std::ranges::all_of(candidate.parameters, [](const FitParameter& parameter) {
      return parameter.role == Role::kFactor;
    });
  }
  if (effect.kind() != Kind::kLoadFriction) return true;
  const SiteMotion at{problem_.machine().plant(),
                      problem_.machine().linear(),
                      motion_,
                      {candidate.site, candidate.joint, candidate.channel}};
  const VectorXd load = at.motor();
  const double power = load.squaredNorm() / static_cast<double>(load.size());
  return std::pow(missing_rms_[candidate.joint], 2) <= kMuch * power;
}

/// Trials whose forces are within the band.
std::vector<Trial> ForceColumns::Within(const Candidate& candidate) const {
  const auto sweep =
      MakeSweep(problem_.machine(), candidate, of_laws_, problem_.FittedDuration());
  if (!sweep) return MakeTrials(problem_.machine(), candidate, of_laws_);
  std::vector<Trial> trials;
  const VectorXd first = sweep->angle;
  for (std::size_t i = 0; i < sweep->values.size(); ++i) {
    const VectorXd angle = first + static_cast<double>(i) * sweep->increment;
    const Index n = angle.size();
    const VectorXd turns = (angle.tail(n - 1) - angle.head(n - 1)).cwiseAbs() /
                           (2.0 * std::numbers::pi * filtered_.run.sample_time);
    if (std::sqrt(turns.squaredNorm() / static_cast<double>(n)) > filtered_.bandwidth) {
      break;
    }
    trials.push_back(sweep->make(sweep->values[i]));
  }
  return trials;
}

MatrixXd ForceColumns::Of(const Trial& trial) const {
  const Index amplitudes = trial.signals.cols();
  MatrixXd columns = MatrixXd::Zero(rows_.rows(), amplitudes);
  for (Index a = 0; a < amplitudes; ++a) {
    const VectorXd signal = LowPassed(filtered_, trial.signals.col(a));
    for (std::size_t j = 0; j < rows_.dofs.size(); ++j) {
      const double entry = trial.entry(rows_.dofs[j], a);
      if (entry == 0.0) continue;
      columns.col(a).segment(static_cast<Index>(j) * rows_.values(), rows_.values()) =
          entry * signal(rows_.samples);
    }
  }
  if (trial.summed) return columns.rowwise().sum();
  return columns;
}

std::set<Index> ForceColumns::JointsOf(const MatrixXd& columns) const {
  std::set<Index> joints;
  for (Index j = 0; j < std::ssize(rows_.dofs); ++j) {
    if (!columns.middleRows(j * rows_.values(), rows_.values()).isZero(0.0)) {
      joints.insert(j);
    }
  }
  return joints;
}

std::vector<ForceTrial> ForceColumns::TrialsOf(
    const std::vector<Candidate>& candidates) const {
  constexpr double kNothing = 1e-9;  // of the largest force
  constexpr double kFilter = 60.0;   // multiplications for every value
  const double largest = missing_.cwiseAbs().maxCoeff();
  std::vector<std::vector<ForceTrial>> of_each(candidates.size());
  ParallelFor(static_cast<int>(candidates.size()), [&](int number) {
    const auto c = static_cast<std::size_t>(number);
    if (!IsTold(candidates[c])) return;
    const std::vector<Trial> trials = Within(candidates[c]);
    const double cost =
        2.0 * std::log(std::max<double>(1.0, static_cast<double>(trials.size()))) -
        2.0 * std::log(kMissing * candidates[c].effect->odds());
    for (const Trial& trial : trials) {
      if (trial.entry.size() == 0) continue;  // an error of a reading
      MatrixXd columns = Of(trial);
      if (!columns.allFinite() ||
          columns.colwise().norm().minCoeff() < kNothing * largest) {
        continue;
      }
      std::set<Index> joints = JointsOf(columns);
      of_each[c].push_back(
          {c,
           trial.values,
           std::move(joints),
           {std::move(columns), trial.least, ScalesDrive(candidates[c]), cost}});
    }
  });
  std::vector<ForceTrial> all;
  for (std::vector<ForceTrial>& trials : of_each) {
    std::ranges::move(trials, std::back_inserter(all));
  }
  for (const ForceTrial& trial : all) {
    problem_.work()->Add(
        FilterWork(kFilter * static_cast<double>(trial.group.columns.cols()) *
                   static_cast<double>(motion_.samples())));
  }
  return all;
}

}  // namespace mjdiag
