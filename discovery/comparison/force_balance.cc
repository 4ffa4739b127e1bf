#include "mjdiag/discovery/comparison/force_balance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mjdiag/plugin/machine/input_course.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/motion_of_readings.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/derivative.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/zero_phase.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the control rate: what is faster no filter tells from noise.
constexpr double kFastestOfControl = 0.1;
constexpr int kFilterOrder = 2;  // forwards and backwards: four

constexpr double kFastestOfMotion = 32.0;  // times its bandwidth

/// Changes of every row in a tick, over 20 ms to each side.
MatrixXd DifferencesOf(const MatrixXd& rows, double tick) {
  constexpr double kSide = 0.02;  // [s]
  const auto side = std::max<Index>(2, static_cast<Index>(std::lround(kSide / tick)));
  MatrixXd changes(rows.rows(), rows.cols());
  for (Index k = 0; k < rows.cols(); ++k) {
    const Index first = std::max<Index>(0, k - side);
    const Index last = std::min(rows.cols() - 1, k + side);
    changes.col(k) = (rows.col(last) - rows.col(first)) /
                     static_cast<double>(std::max<Index>(1, last - first));
  }
  return changes;
}

/// [rad a tick] Of the fastest reading, by its rms acceleration over its rms velocity.
double MotionBandwidth(const MeasuredRun& run) {
  const MatrixXd velocity = DifferencesOf(run.outputs, run.sample_time);
  const MatrixXd acceleration = DifferencesOf(velocity, run.sample_time);
  return (acceleration.rowwise().norm().array() /
          velocity.rowwise().norm().array().max(1e-300))
      .maxCoeff();
}

/// 32 times the bandwidth of the motion [Hz], its rms acceleration over its rms velocity:
/// what is faster goes with no motion.
double FastestForce(const MeasuredRun& run) {
  return kFastestOfMotion * MotionBandwidth(run) /
         (2.0 * std::numbers::pi * run.sample_time);
}

/// Continued by two periods of the band on either side, by point reflection: a record may
/// begin and end in mid-motion.
VectorXd FilteredPart(const SecondOrderSections& sections, const VectorXd& x,
                      Index pad) {
  const Index n = x.size();
  pad = std::min(pad, n - 1);
  VectorXd longer(n + 2 * pad);
  longer.segment(pad, n) = x;
  for (Index i = 1; i <= pad; ++i) {
    longer[pad - i] = 2.0 * x[0] - x[i];
    longer[pad + n - 1 + i] = 2.0 * x[n - 1] - x[n - 1 - i];
  }
  return FilterZeroPhase(sections, longer).segment(pad, n);
}

Index PeriodIn(const MeasuredRun& run, double bandwidth) {
  return static_cast<Index>(std::lround(1.0 / (bandwidth * run.sample_time)));
}

VectorXd Filtered(const MeasuredRun& run, double bandwidth, const VectorXd& signal) {
  const SecondOrderSections sections = DigitalButterworth(
      FilterKind::kLowPass, kFilterOrder, bandwidth, run.sample_time);
  VectorXd filtered = signal;
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    const Index count = run.SamplesOf(i);
    filtered.segment(first, count) = FilteredPart(
        sections, signal.segment(first, count), 2 * PeriodIn(run, bandwidth));
  }
  return filtered;
}

/// Of every record by itself.
MatrixXd Slopes(const MeasuredRun& run, const MatrixXd& rows) {
  MatrixXd slopes(rows.rows(), rows.cols());
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    const Index count = run.SamplesOf(i);
    for (Index row = 0; row < rows.rows(); ++row) {
      slopes.row(row).segment(first, count) =
          CentralDifference(rows.row(row).segment(first, count), run.sample_time);
    }
  }
  return slopes;
}

/// Mean slopes of rows in the tick that begins at a sample, of every record by itself.
MatrixXd ChangesInTick(const MeasuredRun& run, const MatrixXd& rows) {
  MatrixXd changes = MatrixXd::Zero(rows.rows(), rows.cols());
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    const Index count = run.SamplesOf(i) - 1;
    changes.middleCols(first, count) =
        (rows.middleCols(first + 1, count) - rows.middleCols(first, count)) /
        run.sample_time;
  }
  return changes;
}

/// The joints whose own dry friction is below its bound.
void MarkSticking(const mjData& data, Index sample, ForceBalance& balance) {
  constexpr double kBound = 0.95;
  for (int row = 0; row < data.nefc; ++row) {
    if (data.efc_type[row] != mjCNSTR_FRICTION_DOF) continue;
    if (std::abs(data.efc_force[row]) < kBound * data.efc_frictionloss[row]) {
      balance.sticks(data.efc_id[row], sample) = true;
    }
  }
}

/// The inputs of a tick of the run as they were measured, whichever it is set to.
class InputsOfTick final : public TickControl {
 public:
  explicit InputsOfTick(const FilteredRun& filtered)
      : run_(filtered.run), inputs_(filtered.inputs) {}
  void Set(Index sample) { sample_ = sample; }
  void Tick(std::span<const double>, std::span<double> inputs) noexcept override {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      inputs[i] = inputs_(static_cast<Index>(i), sample_);
    }
  }
  bool IsOn(std::size_t actuator) const noexcept override {
    return run_.on.size() == 0 || run_.on(static_cast<Index>(actuator), sample_) != 0.0;
  }

 private:
  const MeasuredRun& run_;
  const MatrixXd& inputs_;
  Index sample_ = 0;
};

}  // namespace

double BalanceBandwidth(const Machine& machine, const MeasuredRun& run) {
  return std::min(FastestForce(run), kFastestOfControl * machine.rates().control);
}

FilteredRun FilterRun(const Machine& machine, const MeasuredRun& run,
                      double bandwidth) {
  FilteredRun filtered;
  filtered.bandwidth = bandwidth;
  filtered.run = run;
  filtered.inputs = run.inputs;
  for (Index row = 0; row < run.outputs.rows(); ++row) {
    filtered.run.outputs.row(row) =
        Filtered(run, bandwidth, run.outputs.row(row)).transpose();
  }
  for (Index row = 0; row < run.inputs.rows(); ++row) {
    filtered.run.inputs.row(row) =
        Filtered(run, bandwidth, run.inputs.row(row)).transpose();
  }
  std::vector<Index> all(static_cast<std::size_t>(run.samples()));
  std::iota(all.begin(), all.end(), 0);
  const std::vector<MotionPoint> points = MotionOfReadings(machine, filtered.run, all);
  if (points.empty()) {
    throw InputError("balance of forces", "readings that do not say where joints are",
                     "a position sensor for every joint that moves");
  }
  filtered.position.resize(points.front().position.size(), run.samples());
  for (Index k = 0; k < run.samples(); ++k) {
    filtered.position.col(k) = points[static_cast<std::size_t>(k)].position;
  }
  filtered.velocity = Slopes(run, filtered.position);
  filtered.acceleration = ChangesInTick(run, filtered.velocity);
  filtered.counts = SampleMask::Constant(run.samples(), false);
  const Index margin = PeriodIn(run, bandwidth);
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample + margin;
    const Index last = run.records[i].sample + run.SamplesOf(i) - margin;
    for (Index k = first; k < last; ++k) {
      filtered.counts[k] = run.Counted().size() == 0 || run.Counted().col(k).all();
    }
  }
  return filtered;
}

VectorXd DriveFactors(const Machine& machine, const Machine& changed) {
  const MatrixXd share = machine.mechanics().Gamma.cwiseAbs();
  const std::vector<int>& motors = machine.actuator_addresses();
  VectorXd factors(std::ssize(motors));
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const auto row = [&](const Machine& of) {
      return Eigen::Map<const VectorXd>(RowOf(of.plant().actuator_gear, 6, motors[i]),
                                        6)
          .norm();
    };
    factors[static_cast<Index>(i)] = row(changed) / row(machine);
  }
  VectorXd of_dof = VectorXd::Ones(share.rows());
  for (Index dof = 0; dof < share.rows(); ++dof) {
    const double sum = share.row(dof).sum();
    if (sum > 0.0) of_dof[dof] = share.row(dof).dot(factors) / sum;
  }
  return of_dof;
}

VectorXd LowPassed(const FilteredRun& filtered, const VectorXd& signal) {
  return Filtered(filtered.run, filtered.bandwidth, signal);
}

ForceBalance InverseDynamicsResidual(const Machine& machine, const Changes& changes,
                                     const FilteredRun& filtered) {
  const Machine changed = machine.With(changes);
  const MeasuredRun& run = filtered.run;
  const Index nv = changed.plant().nv;
  ForceBalance balance;
  balance.missing.resize(nv, run.samples());
  balance.sticks.setConstant(nv, run.samples(), false);
  ObservedMotion& motion = balance.motion;
  motion.sample_time = run.sample_time;
  motion.time = run.Time();
  const Eigen::Map<const VectorXd> rest(changed.plant().qpos0, nv);
  motion.position = filtered.position.colwise() - rest;
  motion.velocity = filtered.velocity;
  motion.acceleration = filtered.acceleration;
  motion.own_acceleration.resize(nv, run.samples());
  motion.inputs = run.inputs;
  motion.outputs = run.outputs;
  // What hardly drives leaves no force to compare with.
  constexpr double kLeast = 1e-6;
  const VectorXd less = DriveFactors(machine, changed).cwiseMax(kLeast).cwiseInverse();
  MatrixXd M(nv, nv);
  MatrixXd own(nv, run.samples());  // M a / g
  InputsOfTick inputs(filtered);
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    StartedPlant plant = StartPlant(changed, {});
    ChooseSolver(*plant.model);
    Stepper stepper(changed);
    mjData& data = *plant.data;
    for (Index k = run.records[i].sample; k < run.records[i].sample + run.SamplesOf(i);
         ++k) {
      inputs.Set(k);
      VectorXd::Map(data.qpos, nv) = filtered.position.col(k);
      VectorXd::Map(data.qvel, nv) = filtered.velocity.col(k);
      stepper.Advance(*plant.model, data, inputs);
      if (HasDiverged(data)) {
        throw NumericalError("balance of forces: diverged at " +
                             std::to_string(motion.time[k]) + " s");
      }
      MarkSticking(data, k, balance);
      motion.own_acceleration.col(k) =
          (VectorXd::Map(data.qvel, nv) - filtered.velocity.col(k)) / run.sample_time;
      mj_fullM(plant.model.get(), M.data(), data.qM);
      balance.missing.col(k) = less.asDiagonal() * M * filtered.acceleration.col(k);
      own.col(k) = less.asDiagonal() * M * motion.own_acceleration.col(k);
    }
  }
  for (Index dof = 0; dof < nv; ++dof) {
    balance.missing.row(dof) -= LowPassed(filtered, own.row(dof)).transpose();
  }
  return balance;
}

MatrixXd MissingWithoutFriction(const Machine& machine, const FilteredRun& filtered,
                                const ForceBalance& balance) {
  Changes frictionless;
  for (const ModelParameter& number : ModelParameters(machine.plant())) {
    if (IsFriction(number.kind)) {
      frictionless.numbers.emplace_back(number, 0.0);
    }
  }
  if (frictionless.numbers.empty()) return balance.missing;
  return InverseDynamicsResidual(machine, frictionless, filtered).missing;
}

VectorXd MissingRms(const FilteredRun& filtered, const MatrixXd& missing) {
  VectorXd rms(missing.rows());
  for (Index row = 0; row < rms.size(); ++row) {
    const VectorXd kept = Kept(missing.row(row), filtered.counts);
    rms[row] = std::sqrt(kept.squaredNorm() /
                         static_cast<double>(std::max<Index>(1, kept.size())));
  }
  return rms;
}

}  // namespace mjdiag
