#include "mjdiag/discovery/hypotheses/problem.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "mjdiag/discovery/hypotheses/number_sensitivity.h"
#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/structure/late_dampers.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

/// Whether the twin of a plant has the force of the number as well as the plant has
/// (number_sensitivity.h): of a feedback it has that at rest, whatever limits the drive.
bool HasFirstOrder(PlantNumberKind kind) {
  return kind == PlantNumberKind::kGear || !(IsDrive(kind) || IsAdditive(kind));
}

using Eigen::Index;
using Eigen::VectorXd;

// Of a pass over a run for the force of a number, in physics steps.
constexpr double kForces = 1.0;

/// All inputs and all dampers that much later [s].
void AddLateness(const Machine& machine, double delay, Changes& changes) {
  const double late = std::max(delay, 0.0);
  for (const ActuatorSetup& actuator : machine.channels().actuators) {
    changes.effects.push_back(
        {Lasting(InputDelay()), actuator.element, ValuesOf({late})});
  }
  if (auto dampers = LateDampers(machine.plant(), late)) {
    changes.effects.push_back(std::move(*dampers));
  }
}

}  // namespace

/// Found when first asked for, by whichever copy of the problem is asked.
struct DiscoveryProblem::Derived {
  std::once_flag nominal_once;
  std::once_flag linearised_once;
  std::once_flag train_part_once;
  Track nominal;
  std::shared_ptr<const LinearisedRun> linearised;
  std::optional<DiscoveryProblem> train_part;
  Eigen::MatrixXd free_numbers;  ///< of Simulating; of no size: by differences
};

DiscoveryProblem::DiscoveryProblem(Machine machine, Observer observer, MeasuredRun run,
                                   Index skip, Index train)
    : machine_(std::move(machine)),
      observer_(std::move(observer)),
      run_(std::make_shared<MeasuredRun>(std::move(run))),
      skip_(skip),
      train_(train),
      derived_(std::make_shared<Derived>()) {
  if (run_->driven.size() == 0) return;
  MeasuredRun discounted = *run_;
  discounted.Discount(skip_);
  run_ = std::make_shared<MeasuredRun>(std::move(discounted));
}

const Track& DiscoveryProblem::Nominal() const& {
  std::call_once(derived_->nominal_once, [this] {
    work_->Add(RunWork());
    derived_->nominal = FollowRun(machine_, {}, *run_, observer_, true);
  });
  return derived_->nominal;
}

Track DiscoveryProblem::Nominal() const&& { return std::as_const(*this).Nominal(); }

Track DiscoveryProblem::Follow(const Changes& changes) const {
  if (changes == Changes{}) return Nominal();
  work_->Add(RunWork());
  return FollowRun(machine_, changes, *run_, observer_, true);
}

VectorXd DiscoveryProblem::Residual(const Changes& changes) const {
  if (free_errors_) {
    work_->Add(RunWork());
    return Scaled({free_errors_(changes), {}, {}, {}});
  }
  if (changes == Changes{}) return Scaled(Nominal());
  work_->Add(RunWork());
  return Scaled(FollowRun(machine_, changes, *run_, observer_, false));
}

VectorXd DiscoveryProblem::Scaled(const Track& track) const {
  Eigen::MatrixXd scaled =
      observer_.innovation_sd.cwiseInverse().asDiagonal() * track.innovations;
  for (std::size_t i = 1; i < run_->records.size(); ++i) {
    const Index first = run_->records[i].sample;
    scaled.middleCols(first, std::min(skip_, run_->SamplesOf(i))).setZero();
  }
  if (run_->Counted().size() > 0) {
    scaled = run_->Counted().select(scaled.array(), 0.0).matrix().eval();
  }
  VectorXd stacked = Eigen::Map<const VectorXd>(scaled.data(), scaled.size());
  if (shift_ && !free_errors_) stacked += *shift_;
  return stacked;
}

std::shared_ptr<const LinearisedRun> DiscoveryProblem::Linearised(
    const Changes& changes) const {
  const auto linearise = [&] {
    constexpr Index kBlocks = 5000;
    constexpr double kFirstOrder = 2.5;  // times the run alone
    work_->Add(kFirstOrder * RunWork());
    ErrorDynamics dynamics(observer_, std::max<Index>(1, run_->samples() / kBlocks));
    Track track = FollowRun(machine_, changes, *run_, observer_, dynamics);
    return std::make_shared<const LinearisedRun>(
        LinearisedRun{std::move(track), std::move(dynamics)});
  };
  if (changes != Changes{}) return linearise();
  std::call_once(derived_->linearised_once,
                 [&] { derived_->linearised = linearise(); });
  return derived_->linearised;
}

VectorXd DiscoveryProblem::Measured(Index first, Index last) const {
  if (run_->Counted().size() == 0) return {};
  const auto counts = run_->Counted().middleCols(first, last - first).rowwise().count();
  return counts.cast<double>().matrix();
}

double DiscoveryProblem::MeasuredValues(Index first, Index last) const {
  const VectorXd counts = Measured(first, last);
  if (counts.size() > 0) return counts.sum();
  return static_cast<double>(run_->outputs.rows() * (last - first));
}

VectorXd DiscoveryProblem::MeasuredOf(const VectorXd& residual, Index sensor,
                                      Index first, Index last) const {
  const Index channels = run_->outputs.rows();
  const Eigen::Map<const Eigen::MatrixXd> e(residual.data(), channels,
                                            residual.size() / channels);
  const VectorXd all = e.row(sensor).segment(first, last - first);
  if (run_->Counted().size() == 0) return all;
  return Kept(all, run_->CountedOf(sensor, first, last - first));
}

double DiscoveryProblem::FittedDuration() const {
  return run_->Time().segment(skip_, train_ - skip_).maxCoeff() -
         static_cast<double>(skip_ - 1) * run_->sample_time;
}

double DiscoveryProblem::RunWork() const {
  return static_cast<double>(run_->samples() * machine_.rates().substeps) *
         StepWork(machine_.plant().nv);
}

Changes DiscoveryProblem::WithNumbers(Changes changes, const VectorXd& z) const {
  const std::vector<bool> stood_for = StoodFor(changes);
  for (Index i = 0; i < z.size(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    if (z[i] == 0.0 || stood_for[place]) continue;
    const DoubtedNumber& doubted = numbers_[place];
    if (doubted.is_lateness) {
      AddLateness(machine_, doubted.spread * z[i], changes);
      continue;
    }
    changes.numbers.emplace_back(doubted.number, std::exp(doubted.spread * z[i]));
  }
  return changes;
}

std::vector<bool> DiscoveryProblem::StoodFor(const Changes& changes) const {
  std::vector<bool> stood_for(numbers_.size(), false);
  for (const PlacedEffect& placed : changes.effects) {
    const auto number = NumberAt(*placed.effect, machine_.plant(), placed.site);
    if (!number) continue;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      if (!numbers_[i].is_lateness && numbers_[i].number == *number) {
        stood_for[i] = true;
      }
    }
  }
  return stood_for;
}

Eigen::MatrixXd DiscoveryProblem::NumberJacobian(const Changes& changes,
                                                 const VectorXd& z) const {
  if (derived_->free_numbers.size() > 0) {
    Eigen::MatrixXd J = derived_->free_numbers;
    const std::vector<bool> stood_for = StoodFor(changes);
    for (Index i = 0; i < J.cols(); ++i) {
      if (stood_for[static_cast<std::size_t>(i)]) J.col(i).setZero();
    }
    return J;
  }
  // Numbers that act alike together, as all that a machine is made of and the motors that
  // move it, must not seem to differ. Dry friction bends what they do even over small
  // steps, and rounding hides what smaller ones do: of 1 % of all numbers of a wire
  // bonder 17, 0.08 and 0.004 times the noise are left with steps of 1e-4, 1e-6 and 1e-7,
  // and 0.03 with 1e-8. A free simulation of what sticks and slips shows larger ones only.
  const double step = free_errors_ ? 1e-3 : 1e-7;
  const auto p = static_cast<Index>(numbers_.size());
  const VectorXd about = z.size() > 0 ? z : VectorXd::Zero(p);
  std::vector<VectorXd> run(2 * numbers_.size());
  ParallelForAll(static_cast<int>(run.size()), [&](int number) {
    VectorXd moved = about;
    const Index i = number / 2;
    // Nothing acts before its time.
    if (numbers_[static_cast<std::size_t>(i)].is_lateness) {
      moved[i] = std::max(moved[i], step);
    }
    moved[i] += number % 2 == 0 ? step : -step;
    run[static_cast<std::size_t>(number)] = Residual(WithNumbers(changes, moved));
  });
  Eigen::MatrixXd J(run.front().size(), p);
  for (Index i = 0; i < p; ++i) {
    const auto at = static_cast<std::size_t>(2 * i);
    J.col(i) = (run[at] - run[at + 1]) / (2.0 * step);
  }
  return J;
}

Eigen::MatrixXd DiscoveryProblem::RoughNumberJacobian(const Changes& changes,
                                                      const VectorXd& z) const {
  if (free_errors_) return NumberJacobian(changes, z);
  const Changes at = WithNumbers(changes, z);
  const auto run = Linearised(at);
  const ObservedMotion motion = MotionOf(run->track);
  const Machine machine = machine_.With(at);
  std::vector<bool> stood_for = StoodFor(changes);
  std::vector<PlantNumber> by_steps;
  std::vector<Index> places;
  if (run_->on.size() == 0 && !observer_.following &&
      StaysNearRest(machine, run->track)) {
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      const DoubtedNumber& doubted = numbers_[i];
      if (stood_for[i] || doubted.is_lateness || !HasFirstOrder(doubted.number.kind)) {
        continue;
      }
      by_steps.push_back(doubted.number);
      places.push_back(static_cast<Index>(i));
      stood_for[i] = true;
    }
  }
  const VectorXd still = StillSpeed();
  const auto p = static_cast<Index>(numbers_.size());
  std::vector<Eigen::MatrixXd> forces(numbers_.size());
  ParallelForAll(static_cast<int>(p), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    if (stood_for[i]) return;
    const DoubtedNumber& doubted = numbers_[i];
    forces[i] = doubted.spread *
                (doubted.is_lateness
                     ? LatenessForce(machine.plant(), machine_.linear().Gamma, motion)
                     : NumberForce(machine.plant(), machine.actuator_addresses(),
                                   doubted.number, motion, still));
  });
  work_->Add(kForces * RunWork() / machine_.rates().substeps * static_cast<double>(p));
  std::vector<Index> forced;
  for (Index i = 0; i < p; ++i) {
    if (forces[static_cast<std::size_t>(i)].size() > 0) forced.push_back(i);
  }
  // A force that the model has more is one that it lacks less.
  const Index channels = run_->outputs.rows();
  const Index block = run->dynamics.block();
  Eigen::MatrixXd averages =
      Eigen::MatrixXd::Zero(channels * run->dynamics.blocks(), p);
  for (Index dof = 0; dof < machine.plant().nv; ++dof) {
    Eigen::MatrixXd at_dof(run_->samples(), std::ssize(forced));
    for (std::size_t i = 0; i < forced.size(); ++i) {
      at_dof.col(static_cast<Index>(i)) =
          forces[static_cast<std::size_t>(forced[i])].col(dof);
    }
    if (at_dof.isZero(0.0)) continue;
    const Eigen::MatrixXd entry =
        VectorXd::Unit(machine.plant().nv, dof).replicate(1, at_dof.cols());
    averages(Eigen::all, forced) -= run->dynamics.OfForces(entry, at_dof);
  }
  averages /= std::sqrt(static_cast<double>(block));
  if (!by_steps.empty()) {
    constexpr double kPass = 4.0;  // runs
    work_->Add(kPass * RunWork());
    const Eigen::MatrixXd J =
        NumberSensitivity(machine, observer_, *run_, by_steps, block);
    const VectorXd weight =
        observer_.innovation_sd.cwiseInverse().replicate(averages.rows() / channels, 1);
    for (std::size_t i = 0; i < places.size(); ++i) {
      averages.col(places[i]) =
          numbers_[static_cast<std::size_t>(places[i])].spread *
          weight.cwiseProduct(J.col(static_cast<Index>(i)).head(averages.rows()));
    }
  }
  Eigen::MatrixXd J(channels * run_->samples(), p);
  for (Index k = 0; k < run_->samples(); ++k) {
    const Index of = std::min(k / block, run->dynamics.blocks() - 1);
    J.middleRows(channels * k, channels) = averages.middleRows(channels * of, channels);
  }
  for (std::size_t i = 1; i < run_->records.size(); ++i) {
    const Index first = run_->records[i].sample;
    J.middleRows(channels * first, channels * std::min(skip_, run_->SamplesOf(i)))
        .setZero();
  }
  return J;
}

ObservedMotion DiscoveryProblem::MotionOf(const Track& track) const {
  return ObserveMotion(machine_, *run_, track);
}

VectorXd DiscoveryProblem::StillSpeed() const {
  return StillSpeeds(machine_.plant(), observer_.noise_sd, run_->sample_time);
}

DiscoveryProblem DiscoveryProblem::TrainPart() const {
  if (train_ == run_->samples() || free_errors_) return *this;
  std::call_once(derived_->train_part_once,
                 [this] { derived_->train_part = Beginning(*this, train_); });
  return *derived_->train_part;
}

DiscoveryProblem DiscoveryProblem::WithSubsteps(int substeps) const {
  DiscoveryProblem changed = *this;
  if (!in_steps_of_setup_) {
    changed.in_steps_of_setup_ = std::make_shared<const Machine>(machine_);
  }
  changed.machine_ = machine_.WithSubsteps(substeps);
  changed.derived_ = std::make_shared<Derived>();
  return changed;
}

DiscoveryProblem DiscoveryProblem::Shifted(VectorXd shift) const {
  DiscoveryProblem changed = *this;
  changed.shift_ = std::make_shared<const VectorXd>(std::move(shift));
  changed.derived_ = std::make_shared<Derived>();
  return changed;
}

DiscoveryProblem DiscoveryProblem::WithRun(MeasuredRun run) const {
  const Machine& machine = in_steps_of_setup_ ? *in_steps_of_setup_ : machine_;
  Observer observer = OnRun(observer_, machine, run);
  return DiscoveryProblem(machine, std::move(observer), std::move(run), skip_, train_)
      .Charging(work_)
      .Doubting(numbers_);
}

DiscoveryProblem DiscoveryProblem::Charging(std::shared_ptr<Work> work) const {
  DiscoveryProblem changed = *this;
  changed.work_ = std::move(work);
  changed.derived_ = std::make_shared<Derived>();
  return changed;
}

DiscoveryProblem DiscoveryProblem::Doubting(std::vector<DoubtedNumber> numbers) const {
  DiscoveryProblem changed = *this;
  changed.numbers_ = std::move(numbers);
  changed.derived_ = std::make_shared<Derived>();
  return changed;
}

DiscoveryProblem DiscoveryProblem::Simulating(
    std::function<Eigen::MatrixXd(const Changes&)> errors,
    Eigen::MatrixXd numbers) const {
  DiscoveryProblem changed = *this;
  changed.free_errors_ = std::move(errors);
  changed.derived_ = std::make_shared<Derived>();
  changed.derived_->free_numbers = std::move(numbers);
  return changed;
}

DoubtedNumber LatenessOf(const Machine& machine) {
  return {
      .number = {}, .spread = 0.5 * machine.plant().opt.timestep, .is_lateness = true};
}

std::vector<DoubtedNumber> InStepsOf(const Machine& machine,
                                     std::vector<DoubtedNumber> numbers) {
  for (DoubtedNumber& number : numbers) {
    if (number.is_lateness) number = LatenessOf(machine);
  }
  return numbers;
}

std::vector<DoubtedNumber> DoubtsOf(const Machine& machine,
                                    const std::vector<PlantNumber>& known) {
  std::vector<DoubtedNumber> numbers;
  for (const PlantNumber& number : PlantNumbers(machine.plant())) {
    if (std::ranges::find(known, number) != known.end()) continue;
    numbers.push_back({number, DoubtOf(machine.plant(), number)});
  }
  if (!numbers.empty()) numbers.push_back(LatenessOf(machine));
  return numbers;
}

DiscoveryProblem WithDoubts(const DiscoveryProblem& problem,
                            const std::vector<PlantNumber>& known) {
  constexpr double kShows = 0.1;  // standard deviations of all innovations together
  const std::vector<DoubtedNumber> numbers = DoubtsOf(problem.machine(), known);
  if (numbers.empty()) return problem;
  const DiscoveryProblem all = problem.Doubting(numbers);
  const Eigen::MatrixXd J = all.RoughNumberJacobian({}, {});
  std::vector<DoubtedNumber> shown;
  for (Index i = 0; i < J.cols(); ++i) {
    if (J.col(i).norm() > kShows) shown.push_back(numbers[static_cast<std::size_t>(i)]);
  }
  return problem.Doubting(std::move(shown));
}

DiscoveryProblem Beginning(const DiscoveryProblem& problem, Index samples) {
  DiscoveryProblem changed = problem;
  changed.run_ = std::make_shared<const MeasuredRun>(Part(problem.run(), 0, samples));
  changed.train_ = samples;
  changed.derived_ = std::make_shared<DiscoveryProblem::Derived>();
  if (!problem.shift_) return changed;
  return changed.Shifted(problem.shift_->head(problem.run().outputs.rows() * samples));
}

DiscoveryProblem BeginningOf(const DiscoveryProblem& problem) {
  constexpr Index kShortest = 4000;
  const Index quarter = problem.skip() + std::max(kShortest, problem.train() / 4);
  return Beginning(problem, problem.run().records.size() > 1
                                ? problem.train()
                                : std::min(problem.train(), quarter));
}

double MeanSquare(const DiscoveryProblem& problem, const VectorXd& residual,
                  Index first, Index last) {
  if (last <= first) return 0.0;
  const Index channels = problem.run().outputs.rows();
  const double measured = problem.MeasuredValues(first, last);
  return residual.segment(channels * first, channels * (last - first)).squaredNorm() /
         std::max(1.0, measured);
}

}  // namespace mjdiag
