#include "mjdiag/discovery/sets/set_regression.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "mjdiag/discovery/screening/screener.h"
#include "mjdiag/discovery/screening/trial.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kImpossible = std::numeric_limits<double>::infinity();
// A set has to promise that much, in -2 ln L: odds of 20.
constexpr double kLeastGain = 6.0;

/// A trial of a candidate and its columns.
struct Group {
  std::size_t candidate = 0;
  Trial trial;
  Index first = 0;
  Index size = 0;
};

/// Some groups, in order.
struct GroupSet {
  std::vector<std::size_t> groups;
  VectorXd amplitudes;
  double deviance = kImpossible;
};

class Regression {
 public:
  Regression(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
             const FittedModel& present, const MatrixXd& jacobian)
      : seen_(problem.TrainPart()),
        candidates_(candidates),
        present_(present),
        run_(seen_.Linearised(ChangesOf(seen_, candidates, present))),
        motion_(seen_.MotionOf(run_->track)),
        channels_(seen_.run().outputs.rows()),
        block_(dynamics().block()),
        skip_((seen_.skip() + block_ - 1) / block_),
        blocks_(seen_.train() / block_ - skip_),
        rows_(channels_ * blocks_),
        numbers_(present.numbers.size()) {
    RegressOnModel(jacobian);
    MakeTrialsOfAll();
  }

  std::vector<ProposedSet> Propose(int most);

 private:
  const ErrorDynamics& dynamics() const { return run_->dynamics; }
  void RegressOnModel(const MatrixXd& jacobian);
  void MakeTrialsOfAll();
  void AddSweeps(const GroupSet& beside);
  void Add(std::vector<std::pair<std::size_t, Trial>> trials);
  MatrixXd Column(std::size_t candidate, const Trial& trial) const;
  MatrixXd Expanded(const MatrixXd& averages) const;
  bool Weigh(GroupSet& set) const;
  std::vector<GroupSet> Grown(const std::vector<GroupSet>& beam) const;
  std::set<std::size_t> CandidatesOf(const GroupSet& set) const;
  std::vector<GroupSet> Smallest(const std::vector<GroupSet>& sets, double best) const;
  ProposedSet Proposed(const GroupSet& set) const;

  const DiscoveryProblem seen_;
  const std::vector<Candidate>& candidates_;
  const FittedModel& present_;
  std::shared_ptr<const LinearisedRun> run_;
  ObservedMotion motion_;
  Index channels_, block_, skip_, blocks_, rows_, numbers_;
  // Averages of blocks, then what is known of the numbers.
  VectorXd full_, left_;  // residual, and what the model cannot take away of it
  MatrixXd own_;          // what the model can do: its numbers and its causes,
  VectorXd own_scale_;    // over that
  MatrixXd basis_;        // an orthonormal one of it
  std::vector<std::optional<Sweep>> sweeps_;
  std::vector<double> trials_;  // of every candidate
  std::vector<Group> groups_;
  MatrixXd raw_, columns_, G_;  // of blocks only; orthogonal to the basis
  VectorXd b_;
};

void Regression::RegressOnModel(const MatrixXd& jacobian) {
  const auto averaged = [&](const MatrixXd& stacked) {
    return Averaged(
        stacked.middleRows(channels_ * block_ * skip_, channels_ * block_ * blocks_),
        channels_, block_);
  };
  full_.resize(rows_ + numbers_);
  full_ << averaged(seen_.Scaled(run_->track)), present_.numbers;
  left_ = full_;
  if (jacobian.cols() == 0) return;
  own_ = MatrixXd::Zero(rows_ + numbers_, jacobian.cols());
  own_.topRows(rows_) = averaged(jacobian);
  own_.bottomLeftCorner(numbers_, numbers_).setIdentity();
  own_scale_ = own_.colwise().norm().cwiseMax(1e-300);
  own_ *= own_scale_.cwiseInverse().asDiagonal();
  basis_ = OrthonormalColumns(own_);
  left_ -= basis_ * (basis_.transpose() * left_);
}

MatrixXd Regression::Column(std::size_t candidate, const Trial& trial) const {
  const MatrixXd signals = trial.signals.topRows(seen_.train());
  const MatrixXd response =
      (trial.entry.size() > 0
           ? dynamics().OfForces(trial.entry, signals)
           : dynamics().OfReadings(candidates_[candidate].channel, signals))
          .bottomRows(rows_);
  if (trial.summed) return response.rowwise().sum();
  if (!trial.scales_reading) return response;
  MatrixXd column = response;
  for (Index row = candidates_[candidate].channel; row < rows_; row += channels_) {
    column(row, 0) -= full_[row];
  }
  return column;
}

void Regression::MakeTrialsOfAll() {
  const std::size_t count = candidates_.size();
  std::vector<std::vector<Trial>> made(count);
  sweeps_.resize(count);
  trials_.assign(count, 1.0);
  ParallelFor(static_cast<int>(count), [&](int number) {
    const auto c = static_cast<std::size_t>(number);
    if (Has(present_.causes, c)) return;
    sweeps_[c] =
        MakeSweep(seen_.machine(), candidates_[c], motion_, seen_.FittedDuration());
    if (!sweeps_[c]) made[c] = MakeTrials(seen_.machine(), candidates_[c], motion_);
    const std::size_t tried = sweeps_[c] ? sweeps_[c]->values.size() : made[c].size();
    trials_[c] = std::max(1.0, static_cast<double>(tried));
  });
  std::vector<std::pair<std::size_t, Trial>> all;
  for (std::size_t c = 0; c < count; ++c) {
    for (Trial& trial : made[c]) all.emplace_back(c, std::move(trial));
  }
  Add(std::move(all));
}

/// New columns, and G and b with them. Those that the model does itself are none.
void Regression::Add(std::vector<std::pair<std::size_t, Trial>> trials) {
  constexpr double kOwn = 1e-7;       // of a column, squared
  constexpr double kNothing = 1e-12;  // squared
  constexpr double kFilter = 60.0;    // multiplications for every value of a response
  std::vector<MatrixXd> raw(trials.size());
  std::vector<MatrixXd> rest(trials.size());
  ParallelFor(static_cast<int>(trials.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    raw[i] = Column(trials[i].first, trials[i].second);
    rest[i] = MatrixXd::Zero(rows_ + numbers_, raw[i].cols());
    rest[i].topRows(rows_) = raw[i];
    if (basis_.cols() > 0) rest[i] -= basis_ * (basis_.transpose() * rest[i]);
  });
  const Index before = columns_.cols();
  Index count = before;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const VectorXd size = rest[i].colwise().squaredNorm();
    if (!size.allFinite() || size.minCoeff() < kNothing ||
        (size.array() < kOwn * raw[i].colwise().squaredNorm().transpose().array())
            .any()) {
      continue;
    }
    kept.push_back(i);
    groups_.push_back(
        {trials[i].first, std::move(trials[i].second), count, size.size()});
    count += size.size();
  }
  const Index added = count - before;
  seen_.work()->Add(FilterWork((kFilter + static_cast<double>(count + basis_.cols())) *
                               static_cast<double>(rows_ * added)));
  raw_.conservativeResize(rows_, count);
  columns_.conservativeResize(rows_ + numbers_, count);
  Index next = before;
  for (const std::size_t i : kept) {
    raw_.middleCols(next, raw[i].cols()) = raw[i];
    columns_.middleCols(next, raw[i].cols()) = rest[i];
    next += raw[i].cols();
  }
  const auto fresh = columns_.rightCols(added);
  G_.conservativeResize(count, count);
  G_.bottomRightCorner(added, added).noalias() = fresh.transpose() * fresh;
  G_.topRightCorner(before, added).noalias() =
      columns_.leftCols(before).transpose() * fresh;
  G_.bottomLeftCorner(added, before) = G_.topRightCorner(before, added).transpose();
  b_.conservativeResize(count);
  b_.tail(added).noalias() = fresh.transpose() * left_;
}

/// Every sample as its block is.
MatrixXd Regression::Expanded(const MatrixXd& averages) const {
  MatrixXd all = MatrixXd::Zero(channels_ * seen_.train(), averages.cols());
  const double scale = 1.0 / std::sqrt(static_cast<double>(block_));
  for (Index k = 0; k < block_ * blocks_; ++k) {
    all.middleRows(channels_ * (block_ * skip_ + k), channels_) =
        scale * averages.middleRows(channels_ * (k / block_), channels_);
  }
  return all;
}

/// The values of sweeps that promise most of what a set leaves.
void Regression::AddSweeps(const GroupSet& beside) {
  VectorXd left = left_;
  Index columns = 0;
  for (const std::size_t g : beside.groups) columns += groups_[g].size;
  MatrixXd found(rows_, columns + basis_.cols());
  Index next = 0;
  for (const std::size_t g : beside.groups) {
    const auto of_group = columns_.middleCols(groups_[g].first, groups_[g].size);
    left -= of_group * beside.amplitudes.segment(next, groups_[g].size);
    found.middleCols(next, groups_[g].size) = of_group.topRows(rows_);
    next += groups_[g].size;
  }
  if (basis_.cols() > 0) found.rightCols(basis_.cols()) = basis_.topRows(rows_);
  const Screener screener(seen_, dynamics(), Expanded(left.head(rows_)).col(0),
                          found.cols() > 0 ? Expanded(found) : MatrixXd(), {});
  std::vector<std::vector<Trial>> best(candidates_.size());
  ParallelFor(static_cast<int>(candidates_.size()), [&](int number) {
    const auto c = static_cast<std::size_t>(number);
    if (!sweeps_[c]) return;
    best[c] = screener.BestOf(*sweeps_[c], candidates_[c],
                              screener.RoughGains(*sweeps_[c], candidates_[c]));
  });
  std::vector<std::pair<std::size_t, Trial>> all;
  for (std::size_t c = 0; c < best.size(); ++c) {
    for (Trial& trial : best[c]) all.emplace_back(c, std::move(trial));
  }
  Add(std::move(all));
}

/// Its amplitudes and its deviance; false if it is not physical.
bool Regression::Weigh(GroupSet& set) const {
  constexpr double kRidge = 1e-9;
  Index size = 0;
  for (const std::size_t g : set.groups) size += groups_[g].size;
  std::vector<Index> places;
  VectorXd least = VectorXd::Constant(size, -kImpossible);
  for (const std::size_t g : set.groups) {
    const Group& group = groups_[g];
    if (group.trial.least.size() == group.size) {
      least.segment(static_cast<Index>(places.size()), group.size) = group.trial.least;
    }
    for (Index i = 0; i < group.size; ++i) places.push_back(group.first + i);
  }
  const MatrixXd G = G_(places, places);
  const VectorXd b = b_(places);
  const VectorXd unit = G.diagonal().cwiseSqrt().cwiseInverse();
  MatrixXd scaled = unit.asDiagonal() * G * unit.asDiagonal();
  scaled.diagonal().array() += kRidge;
  const VectorXd a = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(b)));
  if (!a.allFinite()) return false;
  if ((a.array() < least.array() - 1e-12 * a.array().abs()).any()) return false;
  double known = 0.0;
  Index next = 0;
  for (const std::size_t g : set.groups) {
    const Group& group = groups_[g];
    const Candidate& candidate = candidates_[group.candidate];
    const VectorXd own = a.segment(next, group.size);
    next += group.size;
    const TrialValues values = group.trial.values(own);
    if (!values) return false;
    known += SizePriorOf(candidates_, {group.candidate, *values});
    for (Index i = 0; i < group.size; ++i) {
      known += std::log1p(G_(group.first + i, group.first + i) * own[i] * own[i]);
    }
    known += 2.0 * std::log(trials_[group.candidate]) -
             2.0 * std::log(kMissing * candidate.effect->odds());
  }
  const double gain = 2.0 * b.dot(a) - a.dot(G * a);
  set.deviance = left_.squaredNorm() - gain + known;
  set.amplitudes = a;
  return true;
}

std::set<std::size_t> Regression::CandidatesOf(const GroupSet& set) const {
  std::set<std::size_t> all;
  for (const std::size_t g : set.groups) all.insert(groups_[g].candidate);
  return all;
}

/// The best sets with one group more.
std::vector<GroupSet> Regression::Grown(const std::vector<GroupSet>& beam) const {
  constexpr std::size_t kBeam = 24;
  std::vector<GroupSet> grown;
  for (const GroupSet& set : beam) {
    const std::set<std::size_t> has = CandidatesOf(set);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (has.contains(groups_[g].candidate)) continue;
      GroupSet& more = grown.emplace_back();
      more.groups = set.groups;
      more.groups.insert(std::ranges::lower_bound(more.groups, g), g);
    }
  }
  std::vector<char> possible(grown.size());
  ParallelFor(static_cast<int>(grown.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    possible[i] = Weigh(grown[i]) ? 1 : 0;
  });
  std::ranges::stable_sort(grown, std::less<>(), &GroupSet::deviance);
  std::vector<GroupSet> best;
  std::set<std::set<std::size_t>> known;
  for (GroupSet& set : grown) {
    if (set.deviance == kImpossible || best.size() == kBeam) break;
    if (known.insert(CandidatesOf(set)).second) best.push_back(std::move(set));
  }
  return best;
}

/// Without those that add nothing to a smaller one. A first order that explains so much is
/// off by a part of that: what a further cause takes away within it may be what the others
/// do there.
std::vector<GroupSet> Regression::Smallest(const std::vector<GroupSet>& sets,
                                           double best) const {
  constexpr double kOff = 1e-3;
  const double off = std::max(kLeastGain, kOff * (left_.squaredNorm() - best));
  std::vector<GroupSet> smallest;
  for (const GroupSet& set : sets) {
    const std::set<std::size_t> all = CandidatesOf(set);
    const bool more = std::ranges::any_of(sets, [&](const GroupSet& other) {
      const std::set<std::size_t> fewer = CandidatesOf(other);
      return fewer.size() < all.size() && std::ranges::includes(all, fewer) &&
             other.deviance <= set.deviance + off;
    });
    if (!more) smallest.push_back(set);
  }
  return smallest;
}

/// With first values of everything, what the model has included.
ProposedSet Regression::Proposed(const GroupSet& set) const {
  constexpr double kLeastFactor = 0.1;
  ProposedSet proposed;
  proposed.gain = left_.squaredNorm() - set.deviance;
  FittedModel& model = proposed.model;
  model = {present_.causes, present_.numbers};
  VectorXd left = full_;
  Index next = 0;
  for (const std::size_t g : set.groups) {
    const Group& group = groups_[g];
    const VectorXd own = set.amplitudes.segment(next, group.size);
    next += group.size;
    left.head(rows_) -= raw_.middleCols(group.first, group.size) * own;
    model.causes.push_back(
        Bounded(candidates_, {group.candidate, *group.trial.values(own)}));
  }
  if (own_.cols() == 0) return proposed;
  const VectorXd step =
      -own_.colPivHouseholderQr().solve(left).cwiseQuotient(own_scale_);
  for (Index i = 0; i < numbers_; ++i) {
    const DoubtedNumber& doubted = seen_.numbers()[static_cast<std::size_t>(i)];
    // Forces are linear in most numbers, and z is their logarithm.
    const double grows = doubted.spread * step[i];
    const double moved =
        doubted.is_lateness
            ? step[i]
            : std::log(std::max(1.0 + grows, kLeastFactor)) / doubted.spread;
    model.numbers[i] =
        std::clamp(model.numbers[i] + moved, doubted.Least(), doubted.Most());
  }
  const VectorXd values = Flatten(present_.causes) + step.tail(step.size() - numbers_);
  const std::vector<FittedCause> moved = WithValues(present_.causes, values);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    model.causes[i] = Bounded(candidates_, moved[i]);
  }
  return proposed;
}

std::vector<ProposedSet> Regression::Propose(int most) {
  constexpr int kMostCauses = 3;
  std::vector<GroupSet> beam(1);
  beam.front().deviance = left_.squaredNorm();
  const GroupSet nothing = beam.front();
  double best = nothing.deviance;
  std::vector<GroupSet> all;
  std::vector<ProposedSet> sets;
  if (numbers_ > 1) sets.push_back(Proposed(nothing));
  for (int size = 1; size <= kMostCauses; ++size) {
    if (size < kMostCauses) AddSweeps(beam.front());
    beam = Grown(beam);
    if (beam.empty() || beam.front().deviance > best - kLeastGain) break;
    best = beam.front().deviance;
    all.insert(all.end(), beam.begin(),
               beam.begin() + std::min<std::ptrdiff_t>(most, std::ssize(beam)));
  }
  for (const GroupSet& set : Smallest(all, best)) sets.push_back(Proposed(set));
  return sets;
}

}  // namespace

std::vector<ProposedSet> ProposeSets(const DiscoveryProblem& problem,
                                     const std::vector<Candidate>& candidates,
                                     const FittedModel& present,
                                     const MatrixXd& jacobian, int most) {
  return Regression(problem, candidates, present, jacobian).Propose(most);
}

}  // namespace mjdiag
