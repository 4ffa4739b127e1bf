#include "mjdiag/studies/excitation/motion_design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>

#include "mjdiag/controllers/setpoint.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/excitation/motion_information.h"
#include "mjdiag/studies/excitation/tone_shares.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRamp = 0.05;  // of the duration

std::vector<std::string> AxisNames(const Setup& setup) {
  std::vector<std::string> names;
  for (const AxisSetup& axis : setup.control.axes) names.push_back(axis.name);
  return names;
}

/// The moves of a trajectory, that many times as far: the same course times that, for the
/// phases of a move depend on how its distance compares with its limits.
Trajectory Shrunk(Trajectory trajectory, double share) {
  if (share == 0.0) trajectory.moves.clear();
  for (Move& move : trajectory.moves) {
    for (auto& [axis, by] : move.by) by *= share;
  }
  for (auto& [axis, limits] : trajectory.limits) {
    limits.velocity *= share;
    limits.acceleration *= share;
    limits.jerk *= share;
    limits.snap *= share;
  }
  if (trajectory.moves.empty()) trajectory.limits.clear();
  return trajectory;
}

/// Tones on the axis of that one.
std::ptrdiff_t OnItsAxis(const Trajectory& trajectory, std::size_t k) {
  return std::ranges::count(trajectory.tones, trajectory.tones[k].axis,
                            &ReferenceTone::axis);
}

class Designer {
 public:
  Designer(const Machine& machine, const MotionDesignOptions& options)
      : machine_(machine),
        options_(options),
        default_(
            machine.setup().trajectories.Find(machine.setup().trajectories.fallback)),
        information_(machine, NumbersWanted()) {}

  MotionDesign Run();

 private:
  /// Moves of a trajectory, and the tones beside them.
  struct Plan {
    const Trajectory* base = nullptr;
    double moves = 0.0;
    ToneShares tones;
  };

  std::vector<std::string> NumbersWanted() const;
  void FindWanted();
  void FindLimits();
  std::vector<double> Frequencies() const;
  void GoToTheMiddle(Trajectory& trajectory) const;
  void TryTones();
  void TryTone(ToneChoice& choice) const;
  std::vector<Plan> Plans() const;
  Trajectory TrajectoryOf(const Plan& plan) const;
  void MeetLimits(Trajectory& trajectory) const;
  double LargestSd(const Trajectory& trajectory) const;
  void Refine(Trajectory& trajectory, double& best);
  void MeetLimitsNonlinear(Trajectory& trajectory);
  std::vector<double> UtilisationOf(const std::vector<AxisCourse>& courses) const;

  Excitation Follow(const Trajectory& trajectory) const {
    return FollowTrajectory(machine_.setup(), trajectory);
  }
  Record LinearRun(const Excitation& motion) const {
    RunOptions quiet;
    quiet.noise_scale = 0.0;
    quiet.linear_part = true;
    return SimulateLinear(machine_, motion, quiet);
  }
  Record Run(const Excitation& motion) const {
    RunOptions quiet;
    quiet.noise_scale = 0.0;
    return Simulate(machine_, motion, quiet);
  }
  bool IsStopped() const { return options_.stop && options_.stop(); }
  void Report(double fraction) const {
    if (options_.progress) options_.progress(fraction, gain_);
  }

  const Machine& machine_;
  const MotionDesignOptions& options_;
  const Trajectory& default_;
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
  const std::vector<std::string> axes = AxisNames(machine_.setup());
  for (const auto& [name, limits] : options_.limits) {
    if (std::ranges::find(axes, name) == axes.end()) {
      throw InputError("limits", "there is no axis '" + name + "'",
                       "an axis of the setup");
    }
  }
  for (const AxisCourse& course :
       CoursesOf(machine_, Follow(default_), design_.run_before)) {
    design_.limits.push_back(PeaksOf(course, machine_.rates().tick()));
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto given = options_.limits.find(axes[i]);
    if (given == options_.limits.end()) continue;
    AxisLimits& own = design_.limits[i];
    for (const auto member :
         {&AxisLimits::lowest, &AxisLimits::highest, &AxisLimits::velocity,
          &AxisLimits::acceleration, &AxisLimits::jerk, &AxisLimits::snap,
          &AxisLimits::force}) {
      if (std::isfinite(given->second.*member)) own.*member = given->second.*member;
    }
  }
}

/// Evenly in their logarithms, and about the resonances of the plant, where a spring
/// shows most.
std::vector<double> Designer::Frequencies() const {
  constexpr int kCount = 36;
  constexpr double kPeriods = 4.0;  // at least, between the ramps
  constexpr double kWeaklyDamped = 0.3;
  const double lowest = kPeriods / default_.duration;
  const double highest = options_.highest_frequency > 0.0
                             ? options_.highest_frequency
                             : 0.25 * machine_.rates().control;
  std::set<double> frequencies;
  for (int i = 0; i < kCount && lowest < highest; ++i) {
    frequencies.insert(lowest * std::pow(highest / lowest, i / (kCount - 1.0)));
  }
  for (const Mode& mode : Modes(machine_.linear())) {
    if (!(mode.damping_ratio < kWeaklyDamped)) continue;
    for (const double widths : {-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0}) {
      const double frequency = mode.frequency * (1.0 + widths * mode.damping_ratio);
      if (frequency > lowest && frequency <= highest) frequencies.insert(frequency);
    }
  }
  return {frequencies.begin(), frequencies.end()};
}

/// Amplitude and information at the limits of its axis, from a run that is long enough to
/// settle.
void Designer::TryTone(ToneChoice& choice) const {
  constexpr double kPeriods = 12.0;
  constexpr double kTicks = 2048.0;
  const double tick = machine_.rates().tick();
  const AxisSetup& axis = machine_.setup().control.axes[choice.axis];
  Trajectory trial;
  trial.name = "tone";
  trial.duration =
      std::min(default_.duration, std::max(kPeriods / choice.frequency, kTicks * tick));
  trial.ramp = 0.25 * trial.duration;
  // Small, and then as large as it may be: all is linear.
  constexpr double kSmall = 1e-6;
  trial.tones = {{axis.name, choice.frequency, kSmall, 0.0}};
  const Excitation motion = Follow(trial);
  const Record run = LinearRun(motion);
  const Index samples = run.samples();
  const Index from = samples / 4;
  const Index count = samples / 2;
  double most = 0.0;
  const std::vector<AxisCourse> courses = CoursesOf(machine_, motion, run);
  for (std::size_t i = 0; i < courses.size(); ++i) {
    AxisLimits peaks = PeaksOf(courses[i], tick);
    AxisLimits limits = design_.limits[i];
    const double half = 0.5 * (limits.highest - limits.lowest);
    limits.lowest = -half;
    limits.highest = half;
    // Of other axes only what it asks of their motors.
    if (i != choice.axis) peaks = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, peaks.force};
    most = std::max(most, Utilisation(peaks, limits));
  }
  choice.amplitude = kSmall / most;
  const double whole = (1.0 - 2.0 * kRamp) * default_.duration / tick;
  choice.information = information_.Of(run, from, count) *
                       (whole / static_cast<double>(count) / (most * most));
}

void Designer::TryTones() {
  const std::vector<double> frequencies = Frequencies();
  for (std::size_t axis = 0; axis < machine_.setup().control.axes.size(); ++axis) {
    for (const double frequency : frequencies)
      choices_.push_back({axis, frequency, 0.0, {}});
  }
  ParallelFor(
      static_cast<int>(choices_.size()),
      [this](int i) {
        if (!IsStopped()) TryTone(choices_[static_cast<std::size_t>(i)]);
      },
      [this](double fraction) { Report(0.1 + 0.6 * fraction); });
  // What was stopped before it was tried tells nothing.
  std::erase_if(choices_, [](const ToneChoice& choice) {
    return choice.information.size() == 0 || !choice.information.allFinite();
  });
}

/// The moves of every trajectory of the setup, or none, in several sizes: the best of each,
/// those that promise most first.
std::vector<Designer::Plan> Designer::Plans() const {
  constexpr double kLeast =
      1e-9;  // of the default motion's information: keeps it regular
  const auto axes = static_cast<Index>(machine_.setup().control.axes.size());
  const Index ticks = design_.run_before.samples();
  const MatrixXd given = information_.Of(LinearRun(Follow(default_)), 0, ticks);
  std::vector<Plan> plans;
  for (const Trajectory& trajectory : machine_.setup().trajectories.all) {
    if (IsStopped() && !plans.empty()) break;
    if (trajectory.moves.empty()) continue;
    Trajectory moves = trajectory;
    moves.tones.clear();
    moves.duration = default_.duration;
    const Excitation motion = Follow(moves);
    const Record run = LinearRun(motion);
    const std::vector<AxisCourse> courses = CoursesOf(machine_, motion, run);
    const std::vector<double> used = UtilisationOf(courses);
    const double most = *std::ranges::max_element(used);
    const MatrixXd information = information_.Of(run, 0, ticks);
    std::optional<Plan> best;
    for (const double part : {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0}) {
      const double share = part / std::max(1.0, most);
      VectorXd budget(axes);
      for (Index i = 0; i < axes; ++i) {
        // Where moves rest at an end of the range there is no room for a tone.
        AxisCourse moved = courses[static_cast<std::size_t>(i)];
        moved.AddTimes(share - 1.0, courses[static_cast<std::size_t>(i)]);
        const double share_used =
            Utilisation(PeaksOf(moved, machine_.rates().tick()),
                        design_.limits[static_cast<std::size_t>(i)]);
        budget[i] = share > 0.0 ? std::max(0.0, 1.0 - share_used) : 1.0;
        if (budget[i] < 1e-6) budget[i] = 0.0;
      }
      Plan plan{&trajectory, share,
                ShareTones(choices_, share * share * information + kLeast * given,
                           budget, wanted_, options_.stop)};
      if (!best || plan.tones.log_sd < best->tones.log_sd) best = std::move(plan);
    }
    plans.push_back(std::move(*best));
  }
  std::ranges::stable_sort(plans, {},
                           [](const Plan& plan) { return plan.tones.log_sd; });
  return plans;
}

/// A motion of tones alone is about the middle of the range, where a gentle move goes
/// before they are large, and back when they are small again.
void Designer::GoToTheMiddle(Trajectory& trajectory) const {
  constexpr double kGentle = 0.5;  // of the limits
  const std::vector<AxisSetup>& axes = machine_.setup().control.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const AxisLimits& limits = design_.limits[i];
    const auto own = default_.limits.find(axes[i].name);
    const double middle = 0.5 * (limits.lowest + limits.highest);
    if (own == default_.limits.end() || !std::isfinite(middle) ||
        std::abs(middle) < 0.01 * (limits.highest - limits.lowest)) {
      continue;
    }
    const MoveLimits gentle{kGentle * own->second.velocity,
                            kGentle * own->second.acceleration,
                            kGentle * own->second.jerk, kGentle * own->second.snap};
    trajectory.limits[axes[i].name] = gentle;
    const double tick = machine_.rates().tick();
    const double time =
        static_cast<double>(Setpoint(middle, gentle, tick).ticks() + 1) * tick;
    trajectory.moves.push_back({0.0, {{axes[i].name, middle}}});
    trajectory.moves.push_back(
        {std::max(0.0, trajectory.duration - time), {{axes[i].name, -middle}}});
  }
}

/// Phases of Schroeder: the tones of an axis do not meet in one peak.
Trajectory Designer::TrajectoryOf(const Plan& plan) const {
  Trajectory trajectory = *plan.base;
  trajectory.tones.clear();
  trajectory = Shrunk(std::move(trajectory), plan.moves);
  trajectory.name = options_.name;
  trajectory.duration = default_.duration;
  if (trajectory.moves.empty()) {
    trajectory.period = 0.0;
    GoToTheMiddle(trajectory);
  }
  trajectory.ramp = kRamp * default_.duration;
  const std::vector<AxisSetup>& axes = machine_.setup().control.axes;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    std::vector<ReferenceTone> own;
    for (std::size_t k = 0; k < choices_.size(); ++k) {
      const double share = plan.tones.shares[static_cast<Index>(k)];
      if (choices_[k].axis != axis || share <= 0.0) continue;
      own.push_back(
          {axes[axis].name, choices_[k].frequency, share * choices_[k].amplitude, 0.0});
    }
    for (std::size_t k = 0; k < own.size(); ++k) {
      const auto i = static_cast<double>(k);
      own[k].phase =
          -std::numbers::pi * i * (i - 1.0) / static_cast<double>(own.size());
      trajectory.tones.push_back(own[k]);
    }
  }
  return trajectory;
}

std::vector<double> Designer::UtilisationOf(
    const std::vector<AxisCourse>& courses) const {
  std::vector<double> used;
  for (std::size_t i = 0; i < courses.size(); ++i) {
    used.push_back(
        Utilisation(PeaksOf(courses[i], machine_.rates().tick()), design_.limits[i]));
  }
  return used;
}

/// Peaks of several tones are less than their sum: as large as the limits allow, axis by
/// axis.
void Designer::MeetLimits(Trajectory& trajectory) const {
  constexpr int kRounds = 3;  // the motors of other axes answer a little
  constexpr int kHalvings = 20;
  constexpr double kMost = 8.0;
  constexpr double kMargin =
      0.998;  // the nonlinear machine is not quite the linear one
  const std::vector<AxisSetup>& axes = machine_.setup().control.axes;
  Trajectory moves = trajectory;
  moves.tones.clear();
  const Excitation still = Follow(moves);
  const std::vector<AxisCourse> base = CoursesOf(machine_, still, LinearRun(still));
  std::vector<std::vector<AxisCourse>> tones;
  for (const AxisSetup& axis : axes) {
    Trajectory own = moves;
    own.moves.clear();
    for (const ReferenceTone& tone : trajectory.tones) {
      if (tone.axis == axis.name) own.tones.push_back(tone);
    }
    const Excitation motion = Follow(own);
    tones.push_back(CoursesOf(machine_, motion, LinearRun(motion)));
  }
  VectorXd factors = VectorXd::Ones(static_cast<Index>(axes.size()));
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      AxisCourse others = base[axis];
      for (std::size_t i = 0; i < axes.size(); ++i) {
        if (i != axis) others.AddTimes(factors[static_cast<Index>(i)], tones[i][axis]);
      }
      const auto use = [&](const AxisCourse& course) {
        return Utilisation(PeaksOf(course, machine_.rates().tick()),
                           design_.limits[axis]);
      };
      // Where it begins may be the end of its range.
      const double allowed = std::max(kMargin, use(others));
      const auto fits = [&](double factor) {
        AxisCourse all = others;
        all.AddTimes(factor, tones[axis][axis]);
        return use(all) <= allowed;
      };
      double low = 0.0;
      double high = kMost;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (fits(middle) ? low : high) = middle;
      }
      factors[static_cast<Index>(axis)] = low;
    }
  }
  for (ReferenceTone& tone : trajectory.tones) {
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (tone.axis == axes[axis].name)
        tone.amplitude *= factors[static_cast<Index>(axis)];
    }
  }
  std::erase_if(trajectory.tones,
                [](const ReferenceTone& tone) { return tone.amplitude == 0.0; });
}

/// Of those wanted, along the whole motion.
double Designer::LargestSd(const Trajectory& trajectory) const {
  const VectorXd sd = information_.SdOf(LinearRun(Follow(trajectory)));
  double largest = 0.0;
  for (const Index at : wanted_) largest = std::max(largest, sd[at]);
  return largest;
}

/// Between the frequencies that were tried, and with harmonics, whose peaks are not the sum
/// of their peaks: as long as one change of one tone makes the whole motion better.
void Designer::Refine(Trajectory& trajectory, double& best) {
  constexpr std::array kSteps = {0.12, 0.04};
  constexpr double kBetter = 0.998;
  constexpr double kHarmonic = 0.05;  // of a tone, three times as fast
  const double highest = Frequencies().back();
  const auto improve = [&](Trajectory other) {
    if (IsStopped()) return false;
    MeetLimits(other);
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
      Trajectory other = trajectory;
      ReferenceTone tone = other.tones[k];
      tone.frequency *= 3.0;
      tone.phase *= 3.0;
      tone.amplitude *= sign * kHarmonic;
      if (tone.frequency > highest) continue;
      other.tones.push_back(tone);
      improve(std::move(other));
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
          Trajectory other = trajectory;
          other.tones[k].frequency *= factor;
          if (other.tones[k].frequency <= highest) better |= improve(std::move(other));
          // All of an axis become as large as its limits allow: one alone has no size.
          if (OnItsAxis(trajectory, k) == 1) continue;
          other = trajectory;
          other.tones[k].amplitude *= std::pow(factor, 3);
          better |= improve(std::move(other));
        }
        if (!better) settled.insert(k);
      }
    }
  }
}

/// Smaller, until the machine itself keeps to its limits.
void Designer::MeetLimitsNonlinear(Trajectory& trajectory) {
  constexpr int kMost = 8;
  constexpr double kRounding = 1e-9;
  for (int i = 0;; ++i) {
    const Excitation motion = Follow(trajectory);
    design_.run_after = Run(motion);
    design_.peaks.clear();
    const std::vector<AxisCourse> courses =
        CoursesOf(machine_, motion, design_.run_after);
    for (const AxisCourse& course : courses) {
      design_.peaks.push_back(PeaksOf(course, machine_.rates().tick()));
    }
    const std::vector<double> used = UtilisationOf(courses);
    const double most = *std::ranges::max_element(used);
    if (most <= 1.0 + kRounding || i == kMost) return;
    const double less = 0.995 / most;
    design_.share_of_moves *= less;
    std::vector<ReferenceTone> tones = trajectory.tones;
    trajectory = Shrunk(std::move(trajectory), less);
    trajectory.tones = std::move(tones);
    for (ReferenceTone& tone : trajectory.tones) tone.amplitude *= less;
  }
}

MotionDesign Designer::Run() {
  FindWanted();
  const Excitation motion = Follow(default_);
  design_.run_before = Run(motion);
  design_.before = information_.SdOf(LinearRun(motion));
  for (const Index at : wanted_) before_ = std::max(before_, design_.before[at]);
  FindLimits();
  Report(0.1);
  TryTones();
  constexpr std::size_t kTried = 3;  // of plans whose first order promises most
  double best = std::numeric_limits<double>::infinity();
  std::vector<Plan> plans = Plans();
  plans.resize(std::min(plans.size(), kTried));
  for (std::size_t i = 0; i < plans.size(); ++i) {
    Report(0.8 + 0.1 * static_cast<double>(i) / static_cast<double>(kTried));
    Trajectory trajectory = TrajectoryOf(plans[i]);
    if (trajectory.moves.empty() && trajectory.tones.empty()) continue;
    MeetLimits(trajectory);
    const double largest = LargestSd(trajectory);
    if (largest >= best) continue;
    best = largest;
    gain_ = before_ / best;
    design_.trajectory = std::move(trajectory);
    design_.share_of_moves = plans[i].moves;
    design_.moves_of = plans[i].moves > 0.0 ? plans[i].base->name : "";
  }
  Report(0.9);
  Refine(design_.trajectory, best);
  MeetLimitsNonlinear(design_.trajectory);
  design_.after = information_.SdOf(LinearRun(Follow(design_.trajectory)));
  design_.stopped = IsStopped();
  Report(1.0);
  return std::move(design_);
}

}  // namespace

double MotionDesign::Gain() const {
  double largest_before = 0.0;
  double largest_after = 0.0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!wanted[i]) continue;
    largest_before = std::max(largest_before, before[static_cast<Index>(i)]);
    largest_after = std::max(largest_after, after[static_cast<Index>(i)]);
  }
  return largest_before / largest_after;
}

MotionDesign DesignMotion(const Machine& machine, const MotionDesignOptions& options) {
  const Setup& setup = machine.setup();
  if (setup.control.axes.empty() || setup.trajectories.fallback.empty()) {
    throw InputError("setup '" + setup.name + "'",
                     "has no controlled axis that follows a trajectory",
                     "[axes] and [trajectories]");
  }
  for (const auto& [axis, limits] : options.limits) {
    for (const auto& [name, value] : Named(limits)) {
      if (value > 0.0 || std::string_view(name) == "lowest" ||
          std::string_view(name) == "highest") {
        continue;
      }
      throw InputError("limits of '" + axis + "'",
                       std::string(name) + " is not above 0", "a number > 0");
    }
  }
  return Designer(machine, options).Run();
}

}  // namespace mjdiag
