#include "mjdiag/discovery/screening.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "mjdiag/plugin/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns that are filtered together: enough to keep the processor busy, few enough to
// stay in memory.
constexpr Index kBatch = 48;

MatrixXd Orthonormal(const MatrixXd& columns) {
  return Eigen::HouseholderQR<MatrixXd>(columns).householderQ() *
         MatrixXd::Identity(columns.rows(), columns.cols());
}

/// What a screening works on: the samples of `problem` that are for fits.
class Screener {
 public:
  Screener(const DiscoveryProblem& problem, const ObservedMotion& motion,
           const VectorXd& residual, const MatrixXd& sensitivities)
      : problem_(problem),
        dynamics_(problem.model, problem.observer, problem.step(),
                  problem.setup->substeps, motion.sticking, BlockOf(problem)),
        channels_(problem.run.outputs.rows()),
        block_(BlockOf(problem)),
        skip_((problem.skip + block_ - 1) / block_),
        blocks_(problem.train / block_ - skip_),
        full_(residual.segment(channels_ * block_ * skip_,
                               channels_ * block_ * blocks_)) {
    if (sensitivities.cols() > 0) {
      const MatrixXd J = sensitivities.middleRows(channels_ * block_ * skip_,
                                                  channels_ * block_ * blocks_);
      const MatrixXd all = Orthonormal(J);
      full_ -= all * (all.transpose() * full_);
      found_ = Orthonormal(Averaged(J, channels_, block_));
    }
    residual_ = Averaged(full_, channels_, block_);
    if (found_.cols() > 0) residual_ -= found_ * (found_.transpose() * residual_);
  }

  /// The starts that trials of one candidate give; those that are not physical or do
  /// not show give none.
  std::vector<Start> Judge(const std::vector<Trial>& trials,
                           const Candidate& candidate) const;

 private:
  /// Blocks of half a millisecond hold what forces do; about 2 kHz.
  static Index BlockOf(const DiscoveryProblem& problem) {
    constexpr double kSeconds = 5e-4;
    return std::max<Index>(1, std::lround(kSeconds / problem.run.sample_time));
  }
  MatrixXd Fast(const Trial& trial, const Candidate& candidate) const;
  MatrixXd Responses(const std::vector<Trial>& trials, std::size_t first,
                     std::size_t last, const Candidate& candidate) const;
  std::optional<Start> Regress(const Trial& trial, const MatrixXd& response,
                               const VectorXd& residual) const;

  const DiscoveryProblem& problem_;
  ErrorDynamics dynamics_;
  Index channels_;
  Index block_;        // samples
  Index skip_;         // blocks
  Index blocks_;       // after them
  VectorXd full_;      // residual of every sample
  VectorXd residual_;  // of every block
  MatrixXd found_;     // orthonormal, of every block
};

/// Columns of trials first .. last - 1 side by side.
MatrixXd Screener::Responses(const std::vector<Trial>& trials, std::size_t first,
                             std::size_t last, const Candidate& candidate) const {
  Index columns = 0;
  for (std::size_t t = first; t < last; ++t) columns += trials[t].signals.cols();
  MatrixXd signals(problem_.train, columns);
  MatrixXd entry(problem_.model.M.rows(), columns);
  const bool forces = trials[first].entry.size() > 0;
  Index next = 0;
  for (std::size_t t = first; t < last; ++t) {
    const Index width = trials[t].signals.cols();
    signals.middleCols(next, width) = trials[t].signals.topRows(problem_.train);
    if (forces) entry.middleCols(next, width) = trials[t].entry;
    next += width;
  }
  return (forces ? dynamics_.OfForces(entry, signals)
                 : dynamics_.OfReadings(candidate.channel, signals))
      .bottomRows(channels_ * blocks_);
}

/// The part of a fast trial in its own sensor, every sample.
MatrixXd Screener::Fast(const Trial& trial, const Candidate& candidate) const {
  return dynamics_.weight()[candidate.channel] *
         trial.signals.middleRows(block_ * skip_, block_ * blocks_);
}

std::optional<Start> Screener::Regress(const Trial& trial, const MatrixXd& response,
                                       const VectorXd& residual) const {
  MatrixXd phi = trial.summed ? MatrixXd(response.rowwise().sum()) : response;
  const VectorXd size = phi.colwise().squaredNorm();
  if (found_.cols() > 0 && !trial.fast) phi -= found_ * (found_.transpose() * phi);
  MatrixXd G = phi.transpose() * phi;
  // A column that what has been found explains already says nothing.
  constexpr double kIndependent = 1e-8;
  for (Index i = 0; i < G.cols(); ++i) {
    if (!(G(i, i) > kIndependent * size[i])) return std::nullopt;
  }
  const VectorXd scale = G.diagonal().cwiseSqrt().cwiseInverse();
  G = scale.asDiagonal() * G * scale.asDiagonal();
  const VectorXd b = scale.asDiagonal() * (phi.transpose() * residual);
  const Eigen::LDLT<MatrixXd> solver(G);
  if (solver.vectorD().minCoeff() < 1e-10) return std::nullopt;
  const VectorXd amplitude = solver.solve(b);
  const Parameters values = trial.parameters(scale.asDiagonal() * amplitude);
  if (!values) return std::nullopt;
  Start start;
  start.parameters = *values;
  start.gain = b.dot(amplitude);
  start.freedom = static_cast<int>(G.cols());
  return start;
}

std::vector<Start> Screener::Judge(const std::vector<Trial>& trials,
                                   const Candidate& candidate) const {
  std::vector<Start> starts;
  const auto keep = [&starts](std::optional<Start> start) {
    if (start) starts.push_back(std::move(*start));
  };
  std::size_t first = 0;
  while (first < trials.size()) {
    if (trials[first].fast) {
      const Eigen::Map<const MatrixXd> channels(full_.data(), channels_,
                                                block_ * blocks_);
      keep(Regress(trials[first], Fast(trials[first], candidate),
                   channels.row(candidate.channel)));
      ++first;
      continue;
    }
    std::size_t last = first;
    Index columns = 0;
    while (last < trials.size() && columns < kBatch && !trials[last].fast) {
      columns += trials[last++].signals.cols();
    }
    const MatrixXd responses = Responses(trials, first, last, candidate);
    Index next = 0;
    for (std::size_t t = first; t < last; ++t) {
      const Index width = trials[t].signals.cols();
      keep(Regress(trials[t], responses.middleCols(next, width), residual_));
      next += width;
    }
    first = last;
  }
  return starts;
}

/// Sines of `count` frequencies from `lowest` on.
std::vector<Trial> Sines(const DiscoveryProblem& problem, const Candidate& candidate,
                         const ObservedMotion& motion, double lowest, double spacing,
                         int count) {
  std::vector<Trial> trials;
  for (int i = 0; i < count; ++i) {
    const double frequency = lowest + spacing * i;
    if (frequency <= 0.0) continue;
    trials.push_back(SineTrial(problem.model, candidate, motion, frequency));
  }
  return trials;
}

/// The largest first, `count` of them.
void KeepBest(std::vector<Start>& starts, std::size_t count) {
  std::ranges::stable_sort(starts, std::greater<>(), &Start::gain);
  if (starts.size() > count) starts.resize(count);
}

/// What a vibration is looked for on: the beginning of the record on a coarse grid of
/// frequencies, the whole of it about the best of them.
class VibrationSearch {
 public:
  VibrationSearch(const DiscoveryProblem& problem, const ObservedMotion& motion,
                  const VectorXd& residual, const MatrixXd& sensitivities)
      : problem_(problem),
        motion_(motion),
        beginning_(Shortened(problem)),
        coarse_(beginning_, motion, residual, sensitivities),
        fine_(problem, motion, residual, sensitivities) {}

  std::vector<Start> Search(const Candidate& candidate) const {
    const double resolution = 1.0 / Duration(beginning_);
    const double highest = std::min(0.1 / problem_.run.sample_time, 400.0);
    constexpr double kSpacing = 0.7;  // of the resolution
    const int count = static_cast<int>(highest / (kSpacing * resolution));
    std::vector<Start> coarse;
    // One batch after the other, for memory.
    for (int first = 1; first <= count; first += kBatch / 2) {
      const int size = std::min<int>(kBatch / 2, count + 1 - first);
      const auto some = coarse_.Judge(
          Sines(beginning_, candidate, motion_, kSpacing * resolution * first,
                kSpacing * resolution, size),
          candidate);
      coarse.insert(coarse.end(), some.begin(), some.end());
    }
    KeepBest(coarse, 3);
    std::vector<Start> found;
    const double step = 0.35 / Duration(problem_);
    const int reach = static_cast<int>(0.5 * resolution / step) + 1;
    for (const Start& start : coarse) {
      const double about = start.parameters.at("frequency");
      auto some = fine_.Judge(Sines(problem_, candidate, motion_, about - reach * step,
                                    step, 2 * reach + 1),
                              candidate);
      KeepBest(some, 1);
      found.insert(found.end(), some.begin(), some.end());
    }
    return found;
  }

 private:
  static DiscoveryProblem Shortened(const DiscoveryProblem& problem) {
    constexpr Index kSamples = 8000;
    DiscoveryProblem shortened = problem;
    shortened.train = std::min(problem.train, problem.skip + kSamples);
    return shortened;
  }
  static double Duration(const DiscoveryProblem& problem) {
    return static_cast<double>(problem.train - problem.skip) * problem.run.sample_time;
  }

  const DiscoveryProblem& problem_;
  const ObservedMotion& motion_;
  DiscoveryProblem beginning_;
  Screener coarse_;
  Screener fine_;
};

}  // namespace

Screening Screen(const DiscoveryProblem& problem,
                 const std::vector<Candidate>& candidates, const ObservedMotion& motion,
                 const VectorXd& residual, const MatrixXd& sensitivities,
                 int starts_each) {
  const Screener screener(problem, motion, residual, sensitivities);
  const VibrationSearch vibration(problem, motion, residual, sensitivities);
  std::vector<std::vector<Start>> found(candidates.size());
  std::vector<int> tried(candidates.size());
  ParallelFor(static_cast<int>(candidates.size()), [&](int number) {
    const auto c = static_cast<std::size_t>(number);
    const Candidate& candidate = candidates[c];
    if (candidate.cause.spec.effect == "floor_vibration") {
      found[c] = vibration.Search(candidate);
      tried[c] = static_cast<int>(0.1 * static_cast<double>(problem.train));
    } else {
      const auto trials = MakeTrials(*problem.plant, problem.model, candidate, motion);
      tried[c] = static_cast<int>(trials.size());
      found[c] = screener.Judge(trials, candidate);
    }
    for (Start& start : found[c]) start.candidate = c;
    KeepBest(found[c], static_cast<std::size_t>(starts_each));
  });
  Screening screening;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (tried[c] == 0) screening.not_excited.push_back(c);
    screening.trials += tried[c];
    screening.starts.insert(screening.starts.end(), found[c].begin(), found[c].end());
  }
  KeepBest(screening.starts, screening.starts.size());
  return screening;
}

}  // namespace mjdiag
