#include "mjdiag/plugin/replay/motion_of_readings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Over it a motion is a quadratic polynomial: to each side [s], and samples at least.
constexpr double kSide = 0.02;
constexpr Index kFewest = 3;

/// Value, slope and curvature of every row of `samples` about column `at`, by least
/// squares of first + side .. on both sides, fewer at the ends. rows x 3
MatrixXd QuadraticAt(const Eigen::Ref<const MatrixXd>& samples, Index at, Index side,
                     double tick) {
  const Index first = std::max<Index>(0, at - side);
  const Index last = std::min(samples.cols() - 1, at + side);
  const Index n = last - first + 1;
  MatrixXd basis(n, 3);
  for (Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(first + i - at);
    basis.row(i) << 1.0, t, 0.5 * t * t;
  }
  const MatrixXd normal = basis.transpose() * basis;
  MatrixXd fit =
      Solve(normal, basis.transpose() * samples.middleCols(first, n).transpose())
          .transpose();
  fit.col(1) /= tick;
  fit.col(2) /= tick * tick;
  return fit;
}

Index SideOf(const MeasuredRun& run) {
  return std::max(kFewest, static_cast<Index>(std::lround(kSide / run.sample_time)));
}

/// Joint positions and their first two derivatives that go with those of the readings, one
/// record, from one moment to the next.
class Configurations {
 public:
  explicit Configurations(const Machine& machine)
      : machine_(machine), model_(CopyModel(machine.plant())), weight_(model_->nv) {
    DropScenery(*model_);
    data_ = MakeData(*model_);
    for (int dof = 0; dof < model_->nv; ++dof) {
      weight_[dof] = 1.0 / (1.0 + model_->jnt_stiffness[model_->dof_jntid[dof]]);
    }
  }

  const mjModel& model() const { return *model_; }

  /// Readings before a record may be any: it begins at rest, moved.
  void Begin() {
    position_ = machine_.rest();
    step_.resize(0, 0);
  }

  /// @param readings  ny x 3. Nothing if no positions give them.
  std::optional<MotionPoint> At(const MatrixXd& readings) {
    constexpr int kIterations = 20;
    if (step_.size() == 0) Turn();
    for (int i = 0; i < kIterations; ++i) {
      const VectorXd error = readings.col(0) - Read();
      if (Largest(error, readings.col(0)) <= 1.0) {
        if (i > 1) Turn();
        return MotionPoint{
            position_, step_ * readings.col(1), step_ * readings.col(2), {}};
      }
      position_ += step_ * error;
      if (i > 0) Turn();
    }
    return std::nullopt;
  }

 private:
  VectorXd Read() {
    return SensorReadings(machine_.channels(), *model_, position_, *data_);
  }
  static double Largest(const VectorXd& error, const VectorXd& target) {
    return (error.array().abs() / (1e-9 + 1e-6 * target.array().abs())).maxCoeff();
  }
  /// The least strain that changes the readings, where the machine is now.
  void Turn() {
    const MatrixXd rows =
        OutputMatrix(*model_, machine_.channels(), position_).transpose();
    const MatrixXd weighted = weight_.asDiagonal() * rows.transpose();
    step_ = weighted * PseudoInverse(rows * weighted);
  }

  const Machine& machine_;
  ModelPtr model_;
  DataPtr data_;
  VectorXd weight_;
  VectorXd position_;
  MatrixXd step_;
};

}  // namespace

std::vector<MotionPoint> MotionOfReadings(const Machine& machine,
                                          const MeasuredRun& run,
                                          const std::vector<Index>& samples) {
  const Index side = SideOf(run);
  Configurations configurations(machine);
  std::vector<MotionPoint> points;
  std::size_t record = 0;
  const auto of_record = [&](const MatrixXd& all) {
    return all.middleCols(run.records[record].sample, run.SamplesOf(record));
  };
  configurations.Begin();
  for (const Index sample : samples) {
    while (record + 1 < run.records.size() &&
           run.records[record + 1].sample <= sample) {
      ++record;
      configurations.Begin();
    }
    const Index first = run.records[record].sample;
    auto point = configurations.At(
        QuadraticAt(of_record(run.outputs), sample - first, side, run.sample_time));
    if (!point) return {};
    point->inputs =
        QuadraticAt(of_record(run.inputs), sample - first, side, run.sample_time)
            .col(0);
    points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace mjdiag
