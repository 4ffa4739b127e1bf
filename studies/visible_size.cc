#include "mjdiag/studies/visible_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/discovery/blocks/candidate_regressors.h"
#include "mjdiag/discovery/comparison/noise_floor.h"
#include "mjdiag/discovery/hypotheses/fitted_cause.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Standard deviations of a number from where it is expected: further away it is another
// machine.
constexpr double kFarthest = 10.0;

/// What numbers do to innovations, and that physics steps are late by half of one.
MatrixXd NumbersShown(const ObservedRuns& runs,
                      const std::vector<ModelParameter>& numbers) {
  const Machine& machine = runs.machine();
  const mjModel& plant = machine.plant();
  VectorXd noise(std::ssize(machine.channels().sensors));
  for (Index i = 0; i < noise.size(); ++i) {
    noise[i] = machine.channels().sensors[static_cast<std::size_t>(i)].noise_sd;
  }
  const VectorXd still = StillSpeeds(plant, noise, machine.rates().tick());
  const auto count = std::ssize(numbers);
  std::vector<VectorXd> columns(numbers.size() + 1);
  ParallelFor(static_cast<int>(columns.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const MatrixXd forces =
        number < count
            ? MatrixXd(DoubtOf(plant, numbers[i]) *
                       NumberForce(plant, machine.actuator_addresses(), numbers[i],
                                   runs.motion(), still))
            : MatrixXd(0.5 * plant.opt.timestep *
                       DelayForce(plant, machine.linear().Gamma, runs.motion()));
    // A force that the model has more is one that it lacks less.
    columns[i] = -runs.ResponseTo(forces);
  });
  MatrixXd J(columns.front().size(), std::ssize(columns));
  for (Index i = 0; i < J.cols(); ++i) J.col(i) = columns[static_cast<std::size_t>(i)];
  return J;
}

/// Over what is known of numbers beforehand, columns that have nothing to do with it.
MatrixXd OverNothing(const MatrixXd& columns, Index numbers) {
  MatrixXd all = MatrixXd::Zero(columns.rows() + numbers, columns.cols());
  all.topRows(columns.rows()) = columns;
  return all;
}

/// The candidate that is of the kind of a cause and at its place.
std::optional<std::size_t> PlaceOf(const std::vector<Candidate>& candidates,
                                   const Cause& cause) {
  const auto place = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
    return SameKind({candidate.effect, candidate.site, {}}, cause);
  });
  if (place == candidates.end()) return std::nullopt;
  return static_cast<std::size_t>(place - candidates.begin());
}

/// How a rest that is no white noise makes gains by chance larger.
double OverdispersionBy(const VectorXd& left, Index channels, double sample_time) {
  const double square = left.squaredNorm() / static_cast<double>(left.size());
  if (square < 1.0) return 1.0;
  const Eigen::Map<const MatrixXd> rows(left.data(), channels, left.size() / channels);
  double share = 1.0;
  for (Index c = 0; c < channels; ++c) {
    const VectorXd signal = rows.row(c);
    share = std::min(
        share, IndependentSamples(PowerSpectrum(signal, sample_time), signal.size()) /
                   static_cast<double>(signal.size()));
  }
  return square / share;
}

/// A run beside the machine with numbers and a law that are such that it leaves least.
class LeastLeft {
 public:
  LeastLeft(const ObservedRuns& runs, const std::vector<ModelParameter>& uncertain,
            const MatrixXd& J, const MatrixXd& R, const MeasuredRun& run)
      : runs_(runs), uncertain_(uncertain), J_(J), R_(R), run_(run) {}

  /// @param law  none: numbers alone
  double Square(const Candidate* law, const VectorXd& values) {
    law_ = law;
    x_ = VectorXd::Zero(J_.cols() + values.size());
    x_.tail(values.size()) = Within(values);
    r_ = Innovations(x_);
    double best = kInfinity;
    for (int i = 0; i < kSteps; ++i) {
      const VectorXd step = Step();
      // To first order: what numbers make up for by themselves counts.
      if (i == 0 && law_ == nullptr) best = FirstOrder(step);
      if (i == 0) best = std::min(best, Square(r_, x_));
      if (!StepOn(step, best)) break;
    }
    return best;
  }

  /// After it: what is left of the innovations, others taken away.
  VectorXd Left() const { return LeftOf(r_); }

 private:
  static constexpr int kSteps = 8;

  Index law_size() const { return x_.size() - J_.cols(); }

  VectorXd Within(VectorXd values) const {
    for (Index i = 0; i < values.size(); ++i) {
      const FitParameter& parameter = law_->parameters[static_cast<std::size_t>(i)];
      values[i] = std::clamp(values[i], parameter.lower, parameter.upper);
    }
    return values;
  }

  VectorXd Innovations(const VectorXd& x) const {
    Changes changes;
    if (law_ != nullptr) {
      const VectorXd values = x.tail(law_size());
      changes = ChangesOfFit({*law_}, {{0, values}});
    }
    const mjModel& plant = runs_.machine().plant();
    // That inputs are late is first order only: no step of the model has it.
    for (Index i = 0; i + 1 < J_.cols(); ++i) {
      if (x[i] == 0.0) continue;
      const ModelParameter& number = uncertain_[static_cast<std::size_t>(i)];
      changes.numbers.emplace_back(number, std::exp(DoubtOf(plant, number) * x[i]));
    }
    const Index late = J_.cols() - 1;
    return runs_.Innovations(run_, changes) + J_.col(late) * x[late];
  }

  /// r - R a
  VectorXd LeftOf(const VectorXd& r) const {
    if (R_.cols() == 0) return r;
    return r - R_ * LeastSquares(R_, r);
  }
  /// |r - R a|^2 + |z|^2
  double Square(const VectorXd& r, const VectorXd& x) const {
    return LeftOf(r).squaredNorm() + x.head(J_.cols()).squaredNorm();
  }

  MatrixXd LawColumns() const {
    MatrixXd columns(r_.size(), law_size());
    constexpr double kStep = 1e-4;
    ParallelFor(static_cast<int>(columns.cols()), [&](int i) {
      const FitParameter& parameter = law_->parameters[static_cast<std::size_t>(i)];
      const Index at = J_.cols() + i;
      const double size =
          std::max(std::abs(x_[at]), 1e-3 * std::min(parameter.spread, 1e3));
      VectorXd moved = x_;
      moved[at] += (x_[at] + kStep * size > parameter.upper ? -kStep : kStep) * size;
      columns.col(i) = (Innovations(moved) - r_) / (moved[at] - x_[at]);
    });
    return columns;
  }

  MatrixXd Columns() const {
    const Index p = J_.cols();
    MatrixXd A = MatrixXd::Zero(r_.size() + p, p + law_size() + R_.cols());
    A.topLeftCorner(J_.rows(), p) = J_;
    A.bottomLeftCorner(p, p).setIdentity();
    if (law_size() > 0) A.block(0, p, r_.size(), law_size()) = LawColumns();
    A.topRightCorner(R_.rows(), R_.cols()) = R_;
    return A;
  }

  VectorXd Step() {
    columns_ = Columns();
    VectorXd b(columns_.rows());
    b << r_, x_.head(J_.cols());
    return LeastSquares(columns_, b);
  }

  double FirstOrder(const VectorXd& step) const {
    VectorXd b(columns_.rows());
    b << r_, x_.head(J_.cols());
    return (b - columns_ * step).squaredNorm();
  }

  bool StepOn(const VectorXd& step, double& best) {
    constexpr int kHalvings = 4;
    constexpr double kGain = 1e-4;
    const Index p = J_.cols();
    double part = 1.0;
    for (int i = 0; i < kHalvings; ++i, part *= 0.5) {
      VectorXd x = x_ - part * step.head(x_.size());
      x.head(p) = x.head(p).cwiseMax(-kFarthest).cwiseMin(kFarthest);
      x.tail(law_size()) = Within(x.tail(law_size()));
      try {
        VectorXd r = Innovations(x);
        const double before = Square(r_, x_);
        const double square = Square(r, x);
        if (!(square < before)) continue;
        x_ = std::move(x);
        r_ = std::move(r);
        best = std::min(best, square);
        return square < (1.0 - kGain) * before;
      } catch (const NumericalError&) {
        // A shorter one may stay with the run.
      }
    }
    return false;
  }

  const ObservedRuns& runs_;
  const std::vector<ModelParameter>& uncertain_;
  const MatrixXd& J_;
  const MatrixXd& R_;
  const MeasuredRun& run_;
  const Candidate* law_ = nullptr;
  VectorXd x_;  // z, values of the law
  VectorXd r_;
  MatrixXd columns_;
};

}  // namespace

VisibleSize::VisibleSize(const Machine& machine, int substeps, const Excitation& motion)
    : runs_(machine, motion),
      uncertain_(ModelParameters(machine.plant())),
      numbers_(NumbersShown(runs_, uncertain_)) {
  const MeasuredRun finer = runs_.RunOf(machine.WithSubsteps(substeps));
  const MatrixXd none = NoOthers();
  LeastLeft least(runs_, uncertain_, numbers_, none, finer);
  least.Square(nullptr, VectorXd());
  inflation_ = OverdispersionBy(least.Left(), finer.outputs.rows(), finer.sample_time);
}

Scales VisibleSize::ScalesAt(const Site& site) const {
  const Machine& machine = runs_.machine();
  return ScalesOf(SiteMotion{machine.plant(), machine.linear(), runs_.motion(), site});
}

VectorXd VisibleSize::Innovations(const Cause& cause) const {
  return runs_.InnovationsOf(ChangesOf({cause}));
}

double VisibleSize::Shown(const Cause& cause, const MatrixXd& beside) const {
  const MeasuredRun run = runs_.RunOf(runs_.machine().With(ChangesOf({cause})));
  return LeastLeft(runs_, uncertain_, numbers_, beside, run)
             .Square(nullptr, VectorXd()) /
         inflation_;
}

double VisibleSize::LeftBeside(const MeasuredRun& run, const Candidate& law,
                               VectorXd values, const MatrixXd& others) const {
  try {
    return LeastLeft(runs_, uncertain_, numbers_, others, run).Square(&law, values) /
           inflation_;
  } catch (const NumericalError&) {
    return kInfinity;
  } catch (const InputError&) {
    return kInfinity;
  }
}

double VisibleSize::ShownBesideSimplerLaw(const Cause& cause) const {
  const auto simpler = cause.effect->Simpler(cause);
  if (!simpler) return kInfinity;
  const std::vector<Candidate> candidates = AllSites(runs_.machine());
  const auto place = PlaceOf(candidates, *simpler);
  if (!place) return kInfinity;
  const MeasuredRun run = runs_.RunOf(runs_.machine().With(ChangesOf({cause})));
  return LeftBeside(run, candidates[*place], simpler->values, NoOthers());
}

std::vector<CandidateRegressor> VisibleSize::RegressorsOf(
    const Candidate& law, const VectorXd& innovations) const {
  const ObservedMotion& motion = runs_.motion();
  if (const auto sweep = MakeParameterScan(runs_.machine(), law, motion,
                                           motion.time[motion.samples() - 1])) {
    return {runs_.BestOf(*sweep, law.channel, innovations)};
  }
  return MakeCandidateRegressors(runs_.machine(), law, motion);
}

std::optional<std::pair<VectorXd, double>> VisibleSize::Regressed(
    const CandidateRegressor& trial, const MatrixXd& response,
    const MatrixXd& explained, const VectorXd& left) const {
  constexpr double kIndependent = 1e-8;
  const VectorXd before = response.colwise().squaredNorm();
  const MatrixXd phi = response - explained * (explained.transpose() * response);
  std::vector<Index> free;
  for (Index i = 0; i < phi.cols(); ++i) {
    if (phi.col(i).squaredNorm() > kIndependent * before[i]) free.push_back(i);
  }
  VectorXd amplitude = VectorXd::Zero(phi.cols());
  VectorXd rest = left;
  // What would be below its least is at it, and the others are asked again.
  while (!free.empty()) {
    const VectorXd best = LeastSquares(MatrixXd(phi(Eigen::all, free)), rest);
    std::vector<Index> inside;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Index at = free[i];
      amplitude[at] = best[static_cast<Index>(i)];
      if (trial.least.size() == 0 || amplitude[at] >= trial.least[at]) {
        inside.push_back(at);
      } else {
        amplitude[at] = trial.least[at];
        rest -= phi.col(at) * amplitude[at];
      }
    }
    if (inside.size() == free.size()) break;
    free = std::move(inside);
  }
  const double gain = left.squaredNorm() - (left - phi * amplitude).squaredNorm();
  const RegressorValues values = trial.values(amplitude);
  if (!values || !(gain > 0.0)) return std::nullopt;
  return std::pair{*values, gain};
}

std::optional<VisibleSize::OtherLaw> VisibleSize::BestLaw(const VectorXd& innovations,
                                                          const MatrixXd& others,
                                                          const Cause& but_for) const {
  const Index p = numbers_.cols();
  MatrixXd known(numbers_.rows() + p, p + others.cols());
  known.leftCols(p) << numbers_, MatrixXd::Identity(p, p);
  known.rightCols(others.cols()) = OverNothing(others, p);
  const MatrixXd explained = OrthonormalColumns(known);
  VectorXd left = OverNothing(innovations, p);
  left -= explained * (explained.transpose() * left);
  const std::vector<Candidate> candidates = ListCandidates(runs_.machine());
  std::vector<std::pair<VectorXd, double>> best(candidates.size());
  ParallelFor(static_cast<int>(candidates.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    for (const CandidateRegressor& trial :
         RegressorsOf(candidates[i], left.head(innovations.size()))) {
      const MatrixXd response =
          OverNothing(runs_.Response(trial, candidates[i].channel), p);
      const auto found = Regressed(trial, response, explained, left);
      if (!found || found->second <= best[i].second) continue;
      if (Indistinguishable(CauseOf(candidates, {i, found->first}), but_for)) continue;
      best[i] = *found;
    }
  });
  const auto most = std::ranges::max_element(
      best, std::less<>(), [](const auto& one) { return one.second; });
  if (most == best.end() || !(most->second > 0.0)) return std::nullopt;
  return OtherLaw{candidates[static_cast<std::size_t>(most - best.begin())],
                  most->first, left.squaredNorm() - most->second};
}

double VisibleSize::ShownBesideOtherLaws(const std::vector<Cause>& all,
                                         std::size_t one) const {
  MatrixXd others = NoOthers();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == one) continue;
    others.conservativeResize(Eigen::NoChange, others.cols() + 1);
    others.rightCols(1) = Innovations(all[i]);
  }
  const MeasuredRun run = runs_.RunOf(runs_.machine().With(ChangesOf(all)));
  const auto law = BestLaw(runs_.Innovations(run), others, all[one]);
  if (!law) {
    return LeastLeft(runs_, uncertain_, numbers_, others, run)
               .Square(nullptr, VectorXd()) /
           inflation_;
  }
  const double left = LeftBeside(run, law->law, law->values, others);
  // Beside large causes the first order is off by a share of what they do.
  return all.size() > 1 ? left : std::min(left, law->left / inflation_);
}

}  // namespace mjdiag
