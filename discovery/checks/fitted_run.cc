#include "mjdiag/discovery/checks/fitted_run.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/checks/lag_trend.h"
#include "mjdiag/discovery/checks/nominal_run.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool IsStiffness(const ModelParameter& number) {
  return number.kind == ModelParameterKind::kStiffness ||
         number.kind == ModelParameterKind::kTendonStiffness;
}

/// Those that move resonances: stiffnesses, and what swings where there are none.
std::vector<ModelParameter> NumbersOfFrequencies(const mjModel& plant) {
  std::vector<ModelParameter> all = ModelParameters(plant);
  const bool any = std::ranges::any_of(all, IsStiffness);
  std::erase_if(all, [&](const ModelParameter& number) {
    return any ? !IsStiffness(number)
               : number.kind == ModelParameterKind::kDamping ||
                     number.kind == ModelParameterKind::kTendonDamping ||
                     IsFriction(number.kind);
  });
  return all;
}

/// A run with numbers, and how far it is from the record.
struct NumbersRun {
  VectorXd z;  ///< of the numbers, in their doubts
  Record simulated;
  VectorXd rest;  ///< without what Fit leaves free of every channel
  double square = std::numeric_limits<double>::infinity();
};

class NumbersFit {
 public:
  NumbersFit(const Machine& machine, const Record& measured)
      : machine_(machine),
        measured_(measured),
        numbers_(NumbersOfFrequencies(machine.plant())) {
    for (const SensorSetup& sensor : machine.channels().sensors) Take(sensor.channel);
    if (machine.setup().control.axes.empty()) return;
    for (const AxisSetup& axis : machine.setup().control.axes) Take(axis.actuator);
  }

  Record Fit(const Record& nominal) const {
    constexpr int kRounds = 6;
    constexpr double kImproves = 0.9;
    constexpr double kAstray = 0.1;  // of the moves: a fit may not find its way back
    NumbersRun best =
        RunWith(VectorXd::Zero(static_cast<Index>(numbers_.size())), nominal);
    if (numbers_.empty() || rows_ == 0) return nominal;
    if (best.square > kAstray * static_cast<double>(channels_.size())) {
      TakeBest(StiffnessSteps(), best);
    }
    for (int round = 0; round < kRounds; ++round) {
      const double before = best.square;
      TakeBest(NewtonSteps(best), best);
      if (!(best.square < kImproves * before)) break;
    }
    return best.simulated;
  }

 private:
  void Take(const std::string& channel) {
    const VectorXd moves =
        LagDifferences(CountedSamples(machine_.setup(), measured_, channel));
    const double scale = moves.norm();
    if (!(scale > 0.0)) return;
    channels_.emplace_back(channel, scale);
    rows_ += moves.size();
  }

  /// Differences of a channel over what it moves in the record.
  VectorXd Moves(const Record& record,
                 const std::pair<std::string, double>& channel) const {
    return LagDifferences(CountedSamples(machine_.setup(), record, channel.first)) /
           channel.second;
  }

  std::optional<NumbersRun> TryRun(const VectorXd& z) const {
    NumberFactors factors;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      factors.emplace_back(
          numbers_[i],
          std::exp(DoubtOf(machine_.plant(), numbers_[i]) * z[static_cast<Index>(i)]));
    }
    try {
      return RunWith(z, NominalRun(machine_.WithNumbers(factors), measured_, true));
    } catch (const NumericalError&) {
      return std::nullopt;
    }
  }

  NumbersRun RunWith(const VectorXd& z, const Record& simulated) const {
    NumbersRun run{z, simulated, VectorXd(rows_)};
    Index row = 0;
    for (const auto& channel : channels_) {
      const VectorXd moves = Moves(simulated, channel);
      const Index n = moves.size();
      MatrixXd nuisance(n, 4);
      nuisance.col(0).setOnes();
      nuisance.col(2) = moves;
      nuisance.col(1).setZero();
      nuisance.col(1).segment(1, n - 2) = moves.tail(n - 2) - moves.head(n - 2);
      nuisance.col(3) = nuisance.col(1).cwiseProduct(VectorXd::LinSpaced(n, -0.5, 0.5));
      const VectorXd error = Moves(measured_, channel) - moves;
      run.rest.segment(row, n) = error - nuisance * LeastSquares(nuisance, error);
      row += n;
    }
    run.square = run.rest.squaredNorm();
    return run;
  }

  std::vector<VectorXd> StiffnessSteps() const {
    constexpr double kSmallest = 5e-4;
    constexpr double kLargest = 0.2;
    constexpr double kRatio = 1.5;
    std::vector<VectorXd> steps;
    for (double step = kSmallest; step < kLargest; step *= kRatio) {
      for (const double sign : {-1.0, 1.0}) {
        VectorXd z = VectorXd::Zero(static_cast<Index>(numbers_.size()));
        for (std::size_t i = 0; i < numbers_.size(); ++i) {
          if (!IsStiffness(numbers_[i])) continue;
          z[static_cast<Index>(i)] =
              sign * std::log1p(step) / DoubtOf(machine_.plant(), numbers_[i]);
        }
        if (z.isZero(0.0)) return {};
        steps.push_back(z);
      }
    }
    return steps;
  }

  /// A whole step of Gauss and Newton, and parts of it.
  std::vector<VectorXd> NewtonSteps(const NumbersRun& at) const {
    constexpr double kStep = 1e-3;
    const auto p = static_cast<Index>(numbers_.size());
    MatrixXd J = MatrixXd::Zero(rows_, p);
    ParallelForAll(static_cast<int>(p), [&](int i) {
      const auto moved = TryRun(at.z + kStep * VectorXd::Unit(p, i));
      if (moved) J.col(i) = (at.rest - moved->rest) / kStep;
    });
    const double noise = at.square / static_cast<double>(rows_);
    const MatrixXd information = J.transpose() * J + noise * MatrixXd::Identity(p, p);
    const VectorXd step =
        information.ldlt().solve(J.transpose() * at.rest - noise * at.z);
    if (!step.allFinite()) return {};
    return {at.z + step, at.z + 0.5 * step, at.z + 0.1 * step};
  }

  void TakeBest(const std::vector<VectorXd>& tried, NumbersRun& best) const {
    std::vector<std::optional<NumbersRun>> runs(tried.size());
    ParallelForAll(static_cast<int>(tried.size()), [&](int i) {
      runs[static_cast<std::size_t>(i)] = TryRun(tried[static_cast<std::size_t>(i)]);
    });
    for (std::optional<NumbersRun>& run : runs) {
      if (run && run->square < best.square) best = std::move(*run);
    }
  }

  const Machine& machine_;
  const Record& measured_;
  std::vector<ModelParameter> numbers_;
  std::vector<std::pair<std::string, double>> channels_;  ///< with what they move
  Index rows_ = 0;
};

}  // namespace

Record FittedRun(const Machine& machine, const Record& measured,
                 const Record& nominal) {
  return NumbersFit(machine, measured).Fit(nominal);
}

}  // namespace mjdiag
