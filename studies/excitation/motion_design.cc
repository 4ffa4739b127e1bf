#include "mjdiag/studies/excitation/motion_design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "mjdiag/controllers/setpoint.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/excitation/motion_information.h"
#include "mjdiag/studies/excitation/tone_trials.h"
#include "mjdiag/studies/excitation/tones_within_limits.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MoveLimits Times(double factor, const MoveLimits& limits) {
  return {factor * limits.velocity, factor * limits.acceleration, factor * limits.jerk,
          factor * limits.snap};
}

/// The same course that many times as far: the phases of a move depend on how its distance
/// compares with its limits.
Trajectory Times(double factor, Trajectory trajectory) {
  for (Move& move : trajectory.moves) {
    for (auto& [axis, by] : move.by) by *= factor;
  }
  for (auto& [axis, limits] : trajectory.limits) limits = Times(factor, limits);
  for (ReferenceTone& tone : trajectory.tones) tone.amplitude *= factor;
  return trajectory;
}

Trajectory WithoutTones(Trajectory trajectory) {
  trajectory.tones.clear();
  return trajectory;
}

/// Tones on the axis of that one.
std::ptrdiff_t OnItsAxis(const Trajectory& trajectory, std::size_t k) {
  return std::ranges::count(trajectory.tones, trajectory.tones[k].axis,
                            &ReferenceTone::axis);
}

Record QuietRun(const Machine& machine, const Excitation& motion) {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  return Simulate(machine, motion, quiet);
}

class Designer {
 public:
  Designer(const Machine& machine, const MotionDesignOptions& options)
      : machine_(machine),
        options_(options),
        default_(
            machine.setup().trajectories.Find(machine.setup().trajectories.fallback)),
        motion_(Follow(default_)),
        run_(LinearRun(machine, motion_)),
        information_(machine, NumbersWanted(), run_.samples()) {}

  MotionDesign Run();

 private:
  /// The moves of a trajectory a share as far, none without one, and tones beside them.
  struct Plan {
    const Trajectory* moves_of = nullptr;
    double share = 0.0;
    ToneShares tones;
  };

  std::vector<std::string> NumbersWanted() const;
  void FindWanted();
  void FindLimits();
  void FindTones();
  Plan TonesAlone(const MatrixXd& little) const;
  Plan TonesBeside(const Trajectory& trajectory, const MatrixXd& little) const;
  std::vector<Plan> Plans() const;
  Trajectory MovesOf(const Plan& plan) const;
  std::vector<ReferenceTone> TonesOf(const Plan& plan) const;
  double LargestSd(const Trajectory& trajectory) const;
  void Refine(const TonesWithinLimits& within, Trajectory& trajectory, double& best);
  void KeepToLimits();

  Excitation Follow(const Trajectory& trajectory) const {
    return FollowTrajectory(machine_.setup(), trajectory);
  }
  double tick() const { return machine_.rates().tick(); }
  double HighestFrequency() const {
    return options_.highest_frequency > 0.0 ? options_.highest_frequency
                                            : 0.25 * machine_.rates().control;
  }
  bool IsStopped() const { return options_.stop && options_.stop(); }
  void Report(double fraction) const {
    if (options_.progress) options_.progress(fraction, gain_);
  }

  const Machine& machine_;
  const MotionDesignOptions& options_;
  const Trajectory& default_;
  Excitation motion_;  // the default one,
  Record run_;         // and the linear machine in it
  MotionInformation information_;
  std::vector<Index> wanted_;
  std::vector<ToneChoice> choices_;
  MotionDesign design_;
  double before_ = 0.0;  // the largest standard deviation wanted, default motion
  double gain_ = 1.0;    // of the best motion so far
};

/// Those of what is wanted that are no fault parameters.
std::vector<std::string> Designer::NumbersWanted() const {
  const std::vector<FaultParameter> faults = FaultParameters(machine_.plant());
  std::vector<std::string> numbers;
  for (const std::string& name : options_.wanted) {
    const bool is_fault = std::ranges::any_of(
        faults, [&](const FaultParameter& fault) { return fault.name == name; });
    if (is_fault) continue;
    if (name.find('@') == std::string::npos) {
      std::string known;
      for (const FaultParameter& fault : faults) known += fault.name + ", ";
      throw InputError("wanted", "there is no fault parameter '" + name + "'",
                       known + "or a number of the plant (mass@<body>, ...)");
    }
    numbers.push_back(name);
  }
  return numbers;
}

void Designer::FindWanted() {
  design_.unknowns = information_.unknowns();
  for (std::size_t i = 0; i < design_.unknowns.size(); ++i) {
    const bool wanted = options_.wanted.empty() ||
                        std::ranges::count(options_.wanted, design_.unknowns[i]) > 0;
    design_.wanted.push_back(wanted);
    if (wanted) wanted_.push_back(static_cast<Index>(i));
  }
}

/// What the default motion does, or what is given in its place.
void Designer::FindLimits() {
  const std::vector<std::string> axes =
      NamesOf(machine_.setup().control.axes, &AxisSetup::name);
  for (const auto& [name, limits] : options_.limits) {
    if (std::ranges::find(axes, name) == axes.end()) {
      throw InputError("limits", "there is no axis '" + name + "'",
                       "an axis of the setup");
    }
  }
  for (const AxisCourse& course : CoursesOf(machine_, motion_, design_.run_before)) {
    design_.limits.push_back(PeaksOf(course, tick()));
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto given = options_.limits.find(axes[i]);
    if (given == options_.limits.end()) continue;
    for (const auto& [name, member] : kAxisLimits) {
      const double limit = given->second.*member;
      if (std::isfinite(limit)) design_.limits[i].*member = limit;
    }
  }
}

void Designer::FindTones() {
  choices_ =
      TryTones(machine_, information_, design_.limits,
               {.duration = default_.duration,
                .highest_frequency = HighestFrequency(),
                .stop = options_.stop,
                .progress = [this](double fraction) { Report(0.1 + 0.6 * fraction); }});
}

Designer::Plan Designer::TonesAlone(const MatrixXd& little) const {
  const auto axes = static_cast<Index>(design_.limits.size());
  return {nullptr, 0.0,
          ShareTones(choices_, little, VectorXd::Ones(axes), wanted_, options_.stop)};
}

/// The best of several shares. Where moves rest at an end of the range there is no room for
/// a tone.
Designer::Plan Designer::TonesBeside(const Trajectory& trajectory,
                                     const MatrixXd& little) const {
  constexpr double kNoRoom = 1e-6;
  Trajectory moves = WithoutTones(trajectory);
  moves.duration = default_.duration;
  const Excitation motion = Follow(moves);
  const Record run = LinearRun(machine_, motion);
  const std::vector<AxisCourse> courses = CoursesOf(machine_, motion, run);
  const double most = std::ranges::max(Utilisations(courses, design_.limits, tick()));
  const MatrixXd information = information_.Of(run, 0, run.samples());
  std::optional<Plan> best;
  for (const double part : {0.1, 0.25, 0.5, 0.75, 0.9, 1.0}) {
    const double share = part / std::max(1.0, most);
    std::vector<AxisCourse> moved = courses;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i].AddTimes(share - 1.0, courses[i]);
    }
    const std::vector<double> used = Utilisations(moved, design_.limits, tick());
    const VectorXd left = 1.0 - VectorXd::Map(used.data(), std::ssize(used)).array();
    const VectorXd budget = (left.array() > kNoRoom).select(left, 0.0);
    Plan plan{&trajectory, share,
              ShareTones(choices_, share * share * information + little, budget,
                         wanted_, options_.stop)};
    if (!best || plan.tones.log_sd < best->tones.log_sd) best = std::move(plan);
  }
  return *std::move(best);
}

/// Tones alone, and beside the moves of every trajectory of the setup: those that promise
/// most first.
std::vector<Designer::Plan> Designer::Plans() const {
  constexpr double kLeast = 1e-9;  // of the default motion's: keeps information regular
  const MatrixXd little = kLeast * information_.Of(run_, 0, run_.samples());
  std::vector<Plan> plans = {TonesAlone(little)};
  for (const Trajectory& trajectory : machine_.setup().trajectories.all) {
    if (IsStopped() && plans.size() > 1) break;
    if (trajectory.moves.empty()) continue;
    Plan plan = TonesBeside(trajectory, little);
    // None of moves of an axis that has to rest.
    if (plan.share > 0.0) plans.push_back(std::move(plan));
  }
  std::ranges::stable_sort(plans, {},
                           [](const Plan& plan) { return plan.tones.log_sd; });
  return plans;
}

/// Tones alone are about the middle of the range, where gentle moves go before they are
/// large, and back when they are small again.
Trajectory Designer::MovesOf(const Plan& plan) const {
  constexpr double kGentle = 0.5;  // of the limits
  Trajectory moves;
  if (plan.moves_of != nullptr) moves = WithoutTones(Times(plan.share, *plan.moves_of));
  moves.name = options_.name;
  moves.duration = default_.duration;
  moves.ramp = kToneRamp * default_.duration;
  if (plan.moves_of != nullptr) return moves;
  const std::vector<AxisSetup>& axes = machine_.setup().control.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const AxisLimits& limits = design_.limits[i];
    const auto own = default_.limits.find(axes[i].name);
    const double middle = 0.5 * (limits.lowest + limits.highest);
    const bool rests = limits.velocity == 0.0;
    if (own == default_.limits.end() || rests || !std::isfinite(middle) ||
        std::abs(middle) < 0.01 * (limits.highest - limits.lowest)) {
      continue;
    }
    const MoveLimits gentle = Times(kGentle, own->second);
    const double time =
        static_cast<double>(Setpoint(middle, gentle, tick()).ticks() + 1) * tick();
    moves.limits[axes[i].name] = gentle;
    moves.moves.push_back({0.0, {{axes[i].name, middle}}});
    moves.moves.push_back(
        {std::max(0.0, moves.duration - time), {{axes[i].name, -middle}}});
  }
  return moves;
}

/// Phases of Schroeder: the tones of an axis do not meet in one peak.
std::vector<ReferenceTone> Designer::TonesOf(const Plan& plan) const {
  std::vector<ReferenceTone> tones;
  const std::vector<AxisSetup>& axes = machine_.setup().control.axes;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const std::size_t first = tones.size();
    for (std::size_t k = 0; k < choices_.size(); ++k) {
      const double share = plan.tones.shares[static_cast<Index>(k)];
      if (choices_[k].axis != axis || share <= 0.0) continue;
      tones.push_back(
          {axes[axis].name, choices_[k].frequency, share * choices_[k].amplitude, 0.0});
    }
    const auto own = static_cast<double>(tones.size() - first);
    for (std::size_t k = first; k < tones.size(); ++k) {
      const auto i = static_cast<double>(k - first);
      tones[k].phase = -std::numbers::pi * i * (i - 1.0) / own;
    }
  }
  return tones;
}

/// Of those wanted, along the whole motion.
double Designer::LargestSd(const Trajectory& trajectory) const {
  return information_.SdOf(LinearRun(machine_, Follow(trajectory)))(wanted_).maxCoeff();
}

/// Between the frequencies that were tried, and with harmonics, whose peaks are not the sum
/// of their peaks: as long as one change of one tone makes the whole motion better.
void Designer::Refine(const TonesWithinLimits& within, Trajectory& trajectory,
                      double& best) {
  constexpr std::array kSteps = {0.12, 0.04};
  constexpr double kBetter = 0.998;
  constexpr double kHarmonic = 0.05;  // of a tone, three times as fast
  const double highest = HighestFrequency();
  const auto improve = [&](const std::vector<ReferenceTone>& tones) {
    if (IsStopped()) return false;
    Trajectory other = within.With(tones);
    const double sd = LargestSd(other);
    if (!(sd < kBetter * best)) return false;
    best = sd;
    gain_ = before_ / best;
    trajectory = std::move(other);
    Report(0.95);
    return true;
  };
  const std::size_t given = trajectory.tones.size();
  for (std::size_t k = 0; k < given; ++k) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<ReferenceTone> tones = trajectory.tones;
      ReferenceTone tone = tones[k];
      tone.frequency *= 3.0;
      tone.phase *= 3.0;
      tone.amplitude *= sign * kHarmonic;
      if (tone.frequency > highest) continue;
      tones.push_back(tone);
      improve(tones);
    }
  }
  for (const double step : kSteps) {
    // A tone that does not matter now is looked at again with smaller steps.
    std::set<std::size_t> settled;
    while (settled.size() < trajectory.tones.size() && !IsStopped()) {
      for (std::size_t k = 0; k < trajectory.tones.size(); ++k) {
        if (settled.contains(k)) continue;
        bool better = false;
        for (const double factor : {1.0 + step, 1.0 / (1.0 + step)}) {
          std::vector<ReferenceTone> tones = trajectory.tones;
          tones[k].frequency *= factor;
          if (tones[k].frequency <= highest) better |= improve(tones);
          // All of an axis become as large as its limits allow: one alone has no size.
          if (OnItsAxis(trajectory, k) == 1) continue;
          tones = trajectory.tones;
          tones[k].amplitude *= std::pow(factor, 3);
          better |= improve(tones);
        }
        if (!better) settled.insert(k);
      }
    }
  }
}

/// Smaller, until the nonlinear machine itself keeps to its limits.
void Designer::KeepToLimits() {
  constexpr int kMost = 8;
  constexpr double kRounding = 1e-9;
  for (int i = 0;; ++i) {
    const Excitation motion = Follow(design_.trajectory);
    design_.run_after = QuietRun(machine_, motion);
    const std::vector<AxisCourse> courses =
        CoursesOf(machine_, motion, design_.run_after);
    design_.peaks.clear();
    for (const AxisCourse& course : courses) {
      design_.peaks.push_back(PeaksOf(course, tick()));
    }
    const double most = std::ranges::max(Utilisations(courses, design_.limits, tick()));
    if (most <= 1.0 + kRounding || i == kMost) return;
    const double less = 0.995 / most;
    design_.share_of_moves *= less;
    design_.trajectory = Times(less, std::move(design_.trajectory));
  }
}

MotionDesign Designer::Run() {
  constexpr std::size_t kTried = 3;  // of plans whose first order promises most
  FindWanted();
  design_.run_before = QuietRun(machine_, motion_);
  design_.before = information_.SdOf(run_);
  before_ = design_.before(wanted_).maxCoeff();
  FindLimits();
  Report(0.1);
  FindTones();
  std::vector<Plan> plans = Plans();
  plans.resize(std::min(plans.size(), kTried));
  double best = std::numeric_limits<double>::infinity();
  std::optional<TonesWithinLimits> within;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    Report(0.8 + 0.1 * static_cast<double>(i) / static_cast<double>(kTried));
    TonesWithinLimits own(machine_, design_.limits, MovesOf(plans[i]));
    Trajectory trajectory = own.With(TonesOf(plans[i]));
    if (trajectory.moves.empty() && trajectory.tones.empty()) continue;
    const double largest = LargestSd(trajectory);
    if (largest >= best) continue;
    best = largest;
    gain_ = before_ / best;
    within.emplace(std::move(own));
    design_.trajectory = std::move(trajectory);
    design_.share_of_moves = plans[i].share;
    design_.moves_of = plans[i].moves_of != nullptr ? plans[i].moves_of->name : "";
  }
  Report(0.9);
  if (within) Refine(*within, design_.trajectory, best);
  KeepToLimits();
  design_.after = information_.SdOf(LinearRun(machine_, Follow(design_.trajectory)));
  design_.stopped = IsStopped();
  Report(1.0);
  return std::move(design_);
}

}  // namespace

double MotionDesign::Gain() const {
  const auto largest = [this](const VectorXd& sd) {
    double most = 0.0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i]) most = std::max(most, sd[static_cast<Index>(i)]);
    }
    return most;
  };
  return largest(before) / largest(after);
}

MotionDesign DesignMotion(const Machine& machine, const MotionDesignOptions& options) {
  const Setup& setup = machine.setup();
  if (setup.control.axes.empty() || setup.trajectories.fallback.empty()) {
    throw InputError("setup '" + setup.name + "'",
                     "has no controlled axis that follows a trajectory",
                     "[axes] and [trajectories]");
  }
  for (const auto& [axis, limits] : options.limits) {
    for (const auto& [name, member] : kAxisLimits) {
      const bool is_place =
          member == &AxisLimits::lowest || member == &AxisLimits::highest;
      if (is_place || limits.*member > 0.0) continue;
      throw InputError("limits of '" + axis + "'",
                       std::string(name) + " is not above 0", "a number > 0");
    }
    if (limits.lowest < limits.highest) continue;
    throw InputError("limits of '" + axis + "'", "lowest is not below highest",
                     "room to move in");
  }
  return Designer(machine, options).Run();
}

}  // namespace mjdiag
