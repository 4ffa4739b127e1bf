#include "mjdiag/studies/excitation/joint_motion_design.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "mjdiag/comparison/force_balance.h"
#include "mjdiag/comparison/missing_force.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/excitation/fourier_motion.h"
#include "mjdiag/studies/excitation/inertial_regressor.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the control rate: what is faster no filter tells from noise.
constexpr double kFastestOfControl = 0.1;
// Samples of the fastest period at which a motion is judged.
constexpr Index kJudgedPerPeriod = 12;
// What is smaller of the largest pivot is rounding: numbers that no motion tells.
constexpr double kDependent = 1e-8;
constexpr int kMostHarmonics = 40;
constexpr int kOffspring = 8;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Rows of Y over the noise of their joints, one joint after the other.
MatrixXd RowsAlong(InertialRegressor& regressor, const JointMotion& motion,
                   const std::vector<Index>& columns, const VectorXd& noise) {
  const Index samples = motion.position.cols(), joints = motion.position.rows();
  MatrixXd W(joints * samples, std::ssize(columns));
  for (Index k = 0; k < samples; ++k) {
    const MatrixXd Y = regressor.At(motion.position.col(k), motion.velocity.col(k),
                                    motion.acceleration.col(k));
    for (Index c = 0; c < std::ssize(columns); ++c) {
      for (Index j = 0; j < joints; ++j) {
        W(j * samples + k, c) = Y(j, columns[static_cast<std::size_t>(c)]) / noise[j];
      }
    }
  }
  return W;
}

/// The largest magnitude of the force at every joint, of the plant as it is.
VectorXd PeakForces(InertialRegressor& regressor, const JointMotion& motion) {
  const VectorXd values = regressor.Values();
  VectorXd peaks = VectorXd::Zero(motion.position.rows());
  for (Index k = 0; k < motion.position.cols(); ++k) {
    peaks = peaks.cwiseMax((regressor.At(motion.position.col(k), motion.velocity.col(k),
                                         motion.acceleration.col(k)) *
                            values)
                               .cwiseAbs());
  }
  return peaks;
}

struct Told {
  double condition = kInfinite;
  VectorXd sd;
};

/// @param times  as many values as the motion has independent ones, over its samples
Told WhatIsTold(const MatrixXd& W, double times) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(W.transpose() * W);
  const VectorXd& values = eigen.eigenvalues();
  if (!(values[0] > values.tail(1)[0] * std::numeric_limits<double>::epsilon()))
    return {};
  return {
      std::sqrt(values.tail(1)[0] / values[0]),
      ((eigen.eigenvectors().array().square().rowwise() / values.transpose().array())
           .rowwise()
           .sum() /
       times)
          .sqrt()};
}

class JointMotionDesigner {
 public:
  JointMotionDesigner(const Machine& machine, const MeasuredRun& run,
                      const JointMotionOptions& options)
      : plant_(machine.plant()), options_(options), random_(options.seed) {
    InertialRegressor regressor(plant_);
    design_.sample_time = run.sample_time;
    for (int joint = 0; joint < plant_.njnt; ++joint)
      design_.joints.push_back(ElementName(plant_, mjOBJ_JOINT, joint));
    const FilteredRun filtered = FilterRun(
        machine, run,
        std::min(FastestForce(run), kFastestOfControl * machine.rates().control));
    design_.bandwidth = filtered.bandwidth;
    TakeMeasured(filtered);
    SetLimits(regressor);
    TakeColumns(regressor);
    MeasureNoise(regressor, machine, filtered);
  }

  JointMotionDesign Make() {
    InertialRegressor regressor(plant_);
    const double independent = 2.0 * design_.bandwidth * design_.sample_time;
    const Told before =
        WhatIsTold(RowsAlong(regressor, measured_, columns_, design_.noise), 1.0);
    if (!std::isfinite(before.condition)) {
      throw NumericalError(
          "excite: the measured motion does not tell the numbers of the plant");
    }
    design_.before = before.sd;
    design_.condition_before = before.condition;
    Search();
    const FourierMotion whole(duration_, harmonics_, design_.limits,
                              design_.position_before.cols());
    const JointMotion motion = whole.At(best_);
    const Told after =
        WhatIsTold(RowsAlong(regressor, motion, columns_, design_.noise), independent);
    design_.after = after.sd;
    design_.condition_after = after.condition;
    design_.position = motion.position;
    TakePeaks(regressor, motion);
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
    const auto at = [&](const MatrixXd& all) -> MatrixXd {
      return all(Eigen::all, samples_);
    };
    measured_ = {at(filtered.position), at(filtered.velocity),
                 at(filtered.acceleration)};
    design_.position_before = filtered.position;
    duration_ = design_.sample_time * static_cast<double>(filtered.run.samples() - 1);
  }

  void SetLimits(InertialRegressor& regressor) {
    const VectorXd forces = PeakForces(regressor, measured_);
    for (std::size_t j = 0; j < design_.joints.size(); ++j) {
      const auto row = static_cast<Index>(j);
      const auto peak = [&](const MatrixXd& signal) {
        return signal.row(row).cwiseAbs().maxCoeff();
      };
      AxisLimits limits{.lowest = measured_.position.row(row).minCoeff(),
                        .highest = measured_.position.row(row).maxCoeff(),
                        .velocity = peak(measured_.velocity),
                        .acceleration = peak(measured_.acceleration),
                        .force = forces[row]};
      const auto wanted = options_.limits.find(design_.joints[j]);
      if (wanted != options_.limits.end()) {
        for (const auto& [name, limit] : kAxisLimits) {
          const double value = wanted->second.*limit;
          if (std::isfinite(value)) limits.*limit = value;
        }
      }
      const std::string where = "limits of " + design_.joints[j];
      if (!(limits.highest > limits.lowest))
        throw InputError(where, "an empty range of positions", "lowest < highest");
      if (!(limits.velocity > 0.0 && limits.acceleration > 0.0 && limits.force > 0.0))
        throw InputError(where, "no velocity, acceleration or force", "numbers > 0");
      if (plant_.jnt_limited[j]) {
        const mjtNum* range = RowOf(plant_.jnt_range, 2, static_cast<int>(j));
        if (limits.lowest < range[0] || limits.highest > range[1]) {
          throw InputError(where, "positions beyond the range of the joint",
                           "positions within it");
        }
      }
      design_.limits.push_back(limits);
    }
    for (const auto& [name, limits] : options_.limits) {
      if (std::ranges::find(design_.joints, name) == design_.joints.end()) {
        std::string joints;
        for (const std::string& joint : design_.joints)
          joints += (joints.empty() ? "" : ", ") + joint;
        throw InputError("limits of " + name, "no such joint", "one of " + joints);
      }
    }
    double fastest = options_.highest_frequency;
    if (!(fastest > 0.0)) {
      fastest = kInfinite;
      for (const AxisLimits& limits : design_.limits) {
        fastest = std::min(
            fastest, limits.acceleration / (2.0 * std::numbers::pi * limits.velocity));
      }
    }
    harmonics_ = static_cast<int>(
        std::clamp(std::round(fastest * duration_), 2.0, double{kMostHarmonics}));
    design_.highest_frequency = harmonics_ / duration_;
    judged_.emplace(duration_, harmonics_, design_.limits,
                    kJudgedPerPeriod * harmonics_);
  }

  /// Numbers that a motion within the limits can tell, whatever the measured one tells.
  void TakeColumns(InertialRegressor& regressor) {
    constexpr Index kPositions = 200;
    const Index joints = regressor.joints();
    JointMotion anywhere{MatrixXd(joints, kPositions), MatrixXd(joints, kPositions),
                         MatrixXd(joints, kPositions)};
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    for (Index k = 0; k < kPositions; ++k) {
      for (Index j = 0; j < joints; ++j) {
        const AxisLimits& limits = design_.limits[static_cast<std::size_t>(j)];
        anywhere.position(j, k) =
            0.5 * (limits.lowest + limits.highest) +
            0.5 * share(random) * (limits.highest - limits.lowest);
        anywhere.velocity(j, k) = share(random) * limits.velocity;
        anywhere.acceleration(j, k) = share(random) * limits.acceleration;
      }
    }
    std::vector<Index> all(static_cast<std::size_t>(regressor.numbers()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    MatrixXd W = RowsAlong(regressor, anywhere, all, VectorXd::Ones(joints));
    const VectorXd size = W.colwise().norm();
    for (Index c = 0; c < W.cols(); ++c) {
      if (size[c] > 0.0) W.col(c) /= size[c];
    }
    Eigen::ColPivHouseholderQR<MatrixXd> qr(W);
    qr.setThreshold(kDependent);
    columns_.assign(qr.colsPermutation().indices().data(),
                    qr.colsPermutation().indices().data() + qr.rank());
    std::ranges::sort(columns_);
    for (const Index column : columns_)
      design_.numbers.push_back(regressor.names()[static_cast<std::size_t>(column)]);
    design_.untold = regressor.numbers() - qr.rank();
  }

  /// What the numbers do not explain of what the plant lacks along the record.
  void MeasureNoise(InertialRegressor& regressor, const Machine& machine,
                    const FilteredRun& filtered) {
    const Index joints = regressor.joints(), values = std::ssize(samples_);
    const MatrixXd missing =
        MissingWithoutFriction(machine, filtered, BalanceForces(machine, {}, filtered));
    MatrixXd F(values, joints);
    for (Index k = 0; k < values; ++k)
      F.row(k) = missing.col(samples_[static_cast<std::size_t>(k)]);
    design_.noise = VectorXd::Ones(joints);
    // Once with all joints alike, once with each as noisy as that has shown.
    for (int pass = 0; pass < 2; ++pass) {
      const MatrixXd W = RowsAlong(regressor, measured_, columns_, design_.noise);
      MatrixXd weighted = F;
      for (Index j = 0; j < joints; ++j) weighted.col(j) /= design_.noise[j];
      const VectorXd f = weighted.reshaped();
      const VectorXd left = f - W * W.colPivHouseholderQr().solve(f);
      const double free =
          std::max(1.0, static_cast<double>(values) - static_cast<double>(W.cols()) /
                                                          static_cast<double>(joints));
      for (Index j = 0; j < joints; ++j) {
        design_.noise[j] *=
            std::sqrt(left.segment(j * values, values).squaredNorm() / free);
      }
    }
  }

  /// Its condition number, infinite where it violates a limit.
  double Judge(InertialRegressor& regressor, const VectorXd& parameters) const {
    const JointMotion motion = judged_->At(parameters);
    for (Index k = 0; k < motion.position.cols(); ++k) {
      if (regressor.Touches(motion.position.col(k))) return kInfinite;
    }
    const VectorXd forces = PeakForces(regressor, motion);
    for (Index j = 0; j < forces.size(); ++j) {
      if (forces[j] > design_.limits[static_cast<std::size_t>(j)].force)
        return kInfinite;
    }
    return WhatIsTold(RowsAlong(regressor, motion, columns_, design_.noise), 1.0)
        .condition;
  }

  VectorXd Drawn(double spread) {
    std::normal_distribution<double> normal(0.0, spread);
    VectorXd drawn(judged_->parameters());
    for (double& value : drawn) value = normal(random_);
    return drawn;
  }

  /// An evolution strategy, the best of its parent and eight children, steps by Rechenberg's
  /// rule: larger after a success, smaller till one in five is.
  void Search() {
    std::vector<InertialRegressor> regressors;
    for (int i = 0; i < kOffspring; ++i) regressors.emplace_back(plant_);
    const Index own = judged_->parameters() / std::ssize(design_.joints);
    std::vector<VectorXd> tried(kOffspring);
    std::vector<double> condition(kOffspring);
    double best = kInfinite, step = 0.3;
    for (int round = 0; round < options_.rounds; ++round) {
      if (options_.stop && options_.stop()) {
        design_.stopped = true;
        if (std::isfinite(best)) break;
      }
      for (VectorXd& child : tried) {
        if (std::isfinite(best)) {
          child = best_ + Drawn(step);
        } else {
          // Somewhere in the middle of each range, smaller from round to round.
          child = Drawn(1.0);
          for (Index j = 0; j < std::ssize(design_.joints); ++j) {
            child[(j + 1) * own - 2] = 0.5;
            child[(j + 1) * own - 1] = std::pow(0.9, round);
          }
        }
      }
      ParallelFor(kOffspring, [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        condition[at] = Judge(regressors[at], tried[at]);
      });
      const auto least = std::ranges::min_element(condition);
      if (*least < best) {
        best = *least;
        best_ = tried[static_cast<std::size_t>(least - condition.begin())];
        step *= 1.5;
      } else {
        step *= 0.9;
      }
      if (options_.progress)
        options_.progress(double(round + 1) / options_.rounds, best);
      if (round >= kMostWithoutStart && !std::isfinite(best)) break;
    }
    if (!std::isfinite(best)) {
      throw InputError("limits", "no motion was found that keeps them",
                       "positions that the plant can hold with those forces, and where "
                       "nothing touches");
    }
  }

  void TakePeaks(InertialRegressor& regressor, const JointMotion& motion) {
    const VectorXd forces = PeakForces(regressor, motion);
    for (Index j = 0; j < motion.position.rows(); ++j) {
      design_.peaks.push_back(
          {.lowest = motion.position.row(j).minCoeff(),
           .highest = motion.position.row(j).maxCoeff(),
           .velocity = motion.velocity.row(j).cwiseAbs().maxCoeff(),
           .acceleration = motion.acceleration.row(j).cwiseAbs().maxCoeff(),
           .force = forces[j]});
    }
  }

  static constexpr int kMostWithoutStart = 60;

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
  VectorXd best_;
};

}  // namespace

JointMotionDesign DesignJointMotion(const Machine& machine, const MeasuredRun& run,
                                    const JointMotionOptions& options) {
  return JointMotionDesigner(machine, run, options).Make();
}

}  // namespace mjdiag
