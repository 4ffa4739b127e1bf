#include "mjdiag/studies/excitation/joint_motion_design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "mjdiag/discovery/comparison/force_balance.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/studies/excitation/fourier_motion.h"
#include "mjdiag/studies/excitation/inertial_information.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Samples of the fastest period at which a motion is judged.
constexpr Index kJudgedPerPeriod = 12;
constexpr int kMostHarmonics = 40;
constexpr int kChildren = 8;
// Of the steps of the search, after a round with a success and after one without: as long as
// they are while one round in six has one.
constexpr double kLonger = 1.3;
constexpr double kShorter = 0.95;
// Of parameters that are about 1.
constexpr double kFirstStep = 0.3;
constexpr double kSmallestStep = 0.01;
// Rounds till a motion has to be found that keeps the limits, each smaller than the last.
constexpr int kRoundsToStart = 60;
constexpr double kSmaller = 0.9;

VectorXd PeaksOfRows(const MatrixXd& signals) {
  return signals.cwiseAbs().rowwise().maxCoeff();
}

std::vector<AxisLimits> PeaksAlong(const JointMotion& motion, const VectorXd& forces) {
  const VectorXd velocity = PeaksOfRows(motion.velocity);
  const VectorXd acceleration = PeaksOfRows(motion.acceleration);
  std::vector<AxisLimits> peaks;
  for (Index j = 0; j < motion.position.rows(); ++j) {
    peaks.push_back({.lowest = motion.position.row(j).minCoeff(),
                     .highest = motion.position.row(j).maxCoeff(),
                     .velocity = velocity[j],
                     .acceleration = acceleration[j],
                     .force = forces[j]});
  }
  return peaks;
}

void RequirePossible(const mjModel& plant, int joint, const AxisLimits& limits) {
  const std::string where = "limits of " + ElementName(plant, mjOBJ_JOINT, joint);
  if (!(limits.highest > limits.lowest))
    throw InputError(where, "an empty range of positions", "lowest < highest");
  if (!(limits.velocity > 0.0 && limits.acceleration > 0.0 && limits.force > 0.0))
    throw InputError(where, "no velocity, acceleration or force", "numbers > 0");
  if (!plant.jnt_limited[joint]) return;
  const mjtNum* range = RowOf(plant.jnt_range, 2, joint);
  if (limits.lowest < range[0] || limits.highest > range[1]) {
    throw InputError(where, "positions beyond the range of the joint",
                     "positions within it");
  }
}

class JointMotionDesigner {
 public:
  JointMotionDesigner(const Machine& machine, const MeasuredRun& run,
                      const JointMotionOptions& options)
      : plant_(machine.plant()), options_(options), random_(options.seed) {
    InertialRegressor regressor(plant_);
    design_.sample_time = run.sample_time;
    for (int joint = 0; joint < plant_.njnt; ++joint) {
      design_.joints.push_back(ElementName(plant_, mjOBJ_JOINT, joint));
      design_.joint_units.emplace_back(plant_.jnt_type[joint] == mjJNT_HINGE ? "rad"
                                                                             : "m");
    }
    const FilteredRun filtered =
        FilterRun(machine, run, BalanceBandwidth(machine, run));
    design_.bandwidth = filtered.bandwidth;
    TakeMeasured(filtered);
    SetLimits(regressor);
    columns_ = BaseNumbers(regressor, design_.limits);
    for (const Index column : columns_) {
      const auto at = static_cast<std::size_t>(column);
      design_.numbers.push_back(regressor.names()[at]);
      design_.units.push_back(regressor.units()[at]);
    }
    design_.untold = regressor.numbers() - std::ssize(columns_);
    const MatrixXd missing = MissingWithoutFriction(
        machine, filtered, InverseDynamicsResidual(machine, {}, filtered));
    design_.noise =
        NoiseBeside(regressor, measured_, columns_, missing(Eigen::all, samples_));
    SetSeries();
  }

  JointMotionDesign Make() {
    InertialRegressor regressor(plant_);
    InertialInformation before =
        InformationOf(RowsAlong(regressor, measured_, columns_, design_.noise).W, 1.0);
    if (!std::isfinite(before.condition)) {
      throw NumericalError(
          "excite: the measured motion does not tell the numbers of the plant apart");
    }
    design_.before = std::move(before.sd);
    design_.condition_before = before.condition;
    Search();
    const Index samples = design_.position_before.cols();
    JointMotion motion =
        FourierMotion(duration_, harmonics_, design_.limits, samples).At(best_);
    const InertialRows rows = RowsAlong(regressor, motion, columns_, design_.noise);
    InertialInformation after = InformationOf(rows.W, IndependentOf(samples));
    design_.after = std::move(after.sd);
    design_.condition_after = after.condition;
    design_.peaks = PeaksAlong(motion, rows.force);
    design_.position = std::move(motion.position);
    return std::move(design_);
  }

 private:
  /// The motion as it was, at values that tell something new.
  void TakeMeasured(const FilteredRun& filtered) {
    const Index step = std::max<Index>(
        1, std::lround(0.5 / (design_.bandwidth * design_.sample_time)));
    for (Index k = 0; k < filtered.run.samples(); k += step) {
      if (filtered.counts[k]) samples_.push_back(k);
    }
    measured_ = {filtered.position(Eigen::all, samples_),
                 filtered.velocity(Eigen::all, samples_),
                 filtered.acceleration(Eigen::all, samples_)};
    design_.position_before = filtered.position;
    duration_ = design_.sample_time * static_cast<double>(filtered.run.samples() - 1);
  }

  void SetLimits(InertialRegressor& regressor) {
    const VectorXd forces =
        RowsAlong(regressor, measured_, {}, VectorXd::Ones(regressor.joints())).force;
    design_.limits = PeaksAlong(measured_, forces);
    for (const auto& [name, wanted] : options_.limits) {
      const auto joint = std::ranges::find(design_.joints, name);
      if (joint == design_.joints.end()) {
        throw InputError("limits of " + name, "no such joint",
                         "one of " + Listed(design_.joints));
      }
      if (std::isfinite(wanted.jerk) || std::isfinite(wanted.snap)) {
        throw InputError("limits of " + name, "jerk or snap",
                         "lowest, highest, velocity, acceleration and force, beside a "
                         "measured motion");
      }
      AxisLimits& own =
          design_.limits[static_cast<std::size_t>(joint - design_.joints.begin())];
      for (const auto& [of, limit] : kAxisLimits) {
        if (std::isfinite(wanted.*limit)) own.*limit = wanted.*limit;
      }
    }
    for (int joint = 0; joint < plant_.njnt; ++joint)
      RequirePossible(plant_, joint, design_.limits[static_cast<std::size_t>(joint)]);
  }

  void SetSeries() {
    double fastest = options_.highest_frequency;
    if (!(fastest > 0.0)) {
      // Velocities of a flat spectrum up to f have f / sqrt(3) as their rms frequency.
      fastest = std::sqrt(3.0) / (2.0 * std::numbers::pi) *
                measured_.acceleration.norm() / measured_.velocity.norm();
    }
    harmonics_ = static_cast<int>(
        std::clamp(std::round(fastest * duration_), 2.0, double{kMostHarmonics}));
    design_.highest_frequency = harmonics_ / duration_;
    judged_.emplace(duration_, harmonics_, design_.limits,
                    kJudgedPerPeriod * harmonics_);
  }

  /// Values of the whole motion that tell something new, over samples of it.
  double IndependentOf(Index samples) const {
    return 2.0 * design_.bandwidth * duration_ / static_cast<double>(samples);
  }

  /// Nothing where it violates a limit.
  InertialInformation InformationAlong(InertialRegressor& regressor,
                                       const VectorXd& parameters) const {
    const JointMotion motion = judged_->At(parameters);
    const InertialRows rows = RowsAlong(regressor, motion, columns_, design_.noise);
    if (rows.touches) return {};
    for (Index j = 0; j < rows.force.size(); ++j) {
      if (rows.force[j] > design_.limits[static_cast<std::size_t>(j)].force) return {};
    }
    return InformationOf(rows.W, IndependentOf(motion.position.cols()));
  }

  /// What is made small: the condition number, times how large the standard deviations are
  /// in the geometric mean. The one alone says nothing of how much is told, the other leaves
  /// what is told worst.
  double CostOf(const InertialInformation& told) const {
    if (!std::isfinite(told.condition)) return told.condition;
    return told.condition *
           std::exp((told.sd.array() / design_.before.array()).log().mean());
  }

  void Draw(double spread, Eigen::Ref<VectorXd> into) {
    std::normal_distribution<double> normal(0.0, spread);
    for (double& value : into) value += normal(random_);
  }

  /// Somewhere in the middle of each range.
  VectorXd Start(int round) {
    const Index own = judged_->parameters_of_a_joint();
    VectorXd start = VectorXd::Zero(judged_->parameters());
    Draw(1.0, start);
    for (Index j = 0; j < std::ssize(design_.joints); ++j)
      start.segment<2>((j + 1) * own - 2) << 0.5, std::pow(kSmaller, round);
    return start;
  }

  /// A motion with one joint moved otherwise.
  VectorXd Child(const VectorXd& parent, double step) {
    std::uniform_int_distribution<Index> any(0, std::ssize(design_.joints) - 1);
    const Index own = judged_->parameters_of_a_joint();
    VectorXd child = parent;
    Draw(step, child.segment(any(random_) * own, own));
    return child;
  }

  /// An evolution strategy, the best of a parent and its children (I. Rechenberg,
  /// "Evolutionsstrategie", 1973), from another start when it gets no further. The same for
  /// any number of threads.
  void Search() {
    std::vector<InertialRegressor> regressors;
    for (int i = 0; i < kChildren; ++i) regressors.emplace_back(plant_);
    std::array<VectorXd, kChildren> tried;
    std::array<InertialInformation, kChildren> told;
    VectorXd parent;  // empty: none yet that keeps the limits
    double least = 0.0, least_of_all = CostOf({}), step = 0.0;
    int since = 0;
    for (int round = 0; round < options_.rounds; ++round, ++since) {
      if (best_.size() == 0 && round == kRoundsToStart) break;
      if (best_.size() > 0 && options_.stop && options_.stop()) {
        design_.stopped = true;
        break;
      }
      if (step < kSmallestStep) {
        parent.resize(0);
        least = CostOf({});
        step = kFirstStep;
        since = 0;
      }
      for (VectorXd& child : tried)
        child = parent.size() > 0 ? Child(parent, step) : Start(since);
      ParallelFor(kChildren, [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        told[at] = InformationAlong(regressors[at], tried[at]);
      });
      bool better = parent.size() == 0;
      for (std::size_t i = 0; i < tried.size(); ++i) {
        const double cost = CostOf(told[i]);
        if (!(cost < least)) continue;
        better = true;
        least = cost;
        parent = tried[i];
        if (!(cost < least_of_all)) continue;
        least_of_all = cost;
        best_ = parent;
        condition_ = told[i].condition;
      }
      step *= better ? kLonger : kShorter;
      if (options_.progress)
        options_.progress((round + 1.0) / options_.rounds, condition_);
    }
    if (best_.size() == 0) {
      throw InputError("limits", "no motion was found that keeps them",
                       "positions that the plant can hold with those forces, and where "
                       "nothing touches");
    }
  }

  const mjModel& plant_;
  const JointMotionOptions& options_;
  std::mt19937_64 random_;
  JointMotionDesign design_;
  std::vector<Index> samples_;  // of the run, which tell something new
  JointMotion measured_;        // at those
  double duration_ = 0.0;
  int harmonics_ = 2;
  std::optional<FourierMotion> judged_;
  std::vector<Index> columns_;
  VectorXd best_;  // empty: none yet that keeps the limits
  double condition_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Record JointMotionDesign::Motion() const {
  Record record(sample_time);
  for (std::size_t j = 0; j < joints.size(); ++j)
    record.Add({joints[j], joint_units[j], position.row(static_cast<Index>(j))});
  return record;
}

JointMotionDesign DesignJointMotion(const Machine& machine, const MeasuredRun& run,
                                    const JointMotionOptions& options) {
  return JointMotionDesigner(machine, run, options).Make();
}

}  // namespace mjdiag
