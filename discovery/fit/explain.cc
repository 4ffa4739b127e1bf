#include "mjdiag/discovery/fit/explain.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/fit/tick_columns.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Clock = std::chrono::steady_clock;

class Search {
 public:
  Search(const Machine& machine, const MeasuredRun& run, const VectorXd& reading_sd,
         const ExplainOptions& options)
      : machine_(machine), run_(run), reading_sd_(reading_sd), options_(options) {}

  Explained Run();

 private:
  std::vector<Term> Terms() const;
  struct Settled {
    ModelFit fit;
    FilterPath path;
    double score() const { return path.deviance + fit.prior + fit.occam; }
  };
  Settled Settle(ModelFit fit, const FilterNoise& near) const;
  /// The best of some moves, fitted; none if none pays.
  bool Step();
  Model After(const ModelMove& move) const;
  bool IsOver() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count() >
           options_.seconds;
  }
  void Say(const std::string& text) const {
    if (options_.progress) options_.progress(text);
  }

  const Machine& machine_;
  const MeasuredRun& run_;
  const VectorXd& reading_sd_;
  const ExplainOptions& options_;
  Clock::time_point begin_ = Clock::now();
  Explained found_;
};

/// One coordinate further.
constexpr double kStep = 1e-3;

std::vector<Term> Search::Terms() const {
  const Model& model = found_.fit.model;
  const std::vector<Coordinate> coordinates = CoordinatesOf(found_.blocks, model);
  const VectorXd x = Place(coordinates, model);
  std::vector<OtherMachine> others;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const auto place = static_cast<Index>(i);
    const Coordinate& one = coordinates[i];
    double step = one.is_log ? kStep : std::max(kStep * std::abs(x[place]), 1e-6);
    if (x[place] + step > one.upper) step = -step;
    VectorXd moved = x;
    moved[place] += step;
    others.push_back(
        {machine_.With(ChangesOf(found_.blocks, At(coordinates, model, moved))), step});
  }
  for (std::size_t m = 0; m < model.size(); ++m) {
    Model without = model;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(m));
    others.push_back({machine_.With(ChangesOf(found_.blocks, without))});
  }
  const Machine own = machine_.With(ChangesOf(found_.blocks, model));
  others.push_back({own.WithSubsteps(2 * own.rates().substeps)});
  std::vector<Column> columns = TickColumns(own, run_, found_.path, others);
  std::vector<Term> terms(model.size() + 1);
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    Term& term = terms[coordinates[i].member];
    term.columns.push_back(std::move(columns[i]));
    const auto known = coordinates[i].is_known ? -x[static_cast<Index>(i)] : 0.0;
    const Index count = std::ssize(term.columns);
    term.mean.conservativeResize(count);
    term.mean[count - 1] = known;
  }
  for (std::size_t m = 0; m < model.size(); ++m) {
    terms[m].block = model[m].block;
    terms[m].sd = VectorXd::Ones(terms[m].mean.size());
    terms[m].removed = std::move(columns[coordinates.size() + m]);
  }
  // Half a step is half way to none.
  Term& finer = terms.back();
  finer.is_free = true;
  finer.columns.push_back(std::move(columns.back()));
  finer.sd = VectorXd::Constant(1, 2.0);
  finer.mean = VectorXd::Zero(1);
  return terms;
}

Model Search::After(const ModelMove& move) const {
  Model model;
  for (std::size_t m = 0; m < found_.fit.model.size(); ++m) {
    if (std::ranges::find(move.removed, m) == move.removed.end()) {
      model.push_back(found_.fit.model[m]);
    }
  }
  for (const Added& added : move.added) {
    model.push_back(
        {added.variation.block, *added.variation.values(added.amplitudes)});
  }
  return model;
}

/// A model behind the noise that suits it, fitted anew, until neither gains by the other.
Search::Settled Search::Settle(ModelFit fit, const FilterNoise& near) const {
  const auto filter = [&](const Model& model, const FilterNoise& from) {
    return FilterLikeliestFrom(machine_.With(ChangesOf(found_.blocks, model)), run_,
                               reading_sd_, from);
  };
  Settled settled{std::move(fit), {}};
  settled.path = filter(settled.fit.model, near);
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds && !IsOver(); ++round) {
    const FilterPath& path = settled.path;
    const Machine own = machine_.With(ChangesOf(found_.blocks, settled.fit.model));
    const Whitening whitening(path, KeepGains(path, path.noise, InflationAlong(path)));
    const std::vector<Column> finer = TickColumns(
        own, run_, path, {{own.WithSubsteps(2 * own.rates().substeps)}});
    Settled next{FitModel(machine_, run_, path, whitening.gains(), found_.blocks,
                          settled.fit.model, whitening.Of({&finer.front()}), 4),
                 {}};
    next.path = filter(next.fit.model, path.noise);
    const double gain = settled.score() - next.score();
    if (!(gain > 0.0)) break;
    settled = std::move(next);
    if (gain < 1.0) break;
  }
  return settled;
}

bool Search::Step() {
  const Machine own = machine_.With(ChangesOf(found_.blocks, found_.fit.model));
  const std::vector<Term> terms = Terms();
  const Moves moves = MovesOf(own, run_, found_.path, found_.blocks, terms);
  char text[200];
  std::snprintf(text, sizeof text, "%ld shapes, %zu moves, %.1f", moves.variations,
                moves.best.size(), moves.score);
  Say(text);
  struct Tried {
    ModelFit fit;
    std::size_t noise = 0;
  };
  std::vector<Tried> tried;
  constexpr std::size_t kMost = 4;
  constexpr int kIterations = 6;
  for (const ModelMove& move : moves.best) {
    if (tried.size() == kMost || IsOver()) break;
    if (move.score > moves.score - kLeastGain) break;
    const Whitening& whitening = *moves.whitenings[move.noise];
    const MatrixXd free = whitening.Of({&terms.back().columns.front()});
    try {
      tried.push_back({FitModel(machine_, run_, found_.path, whitening.gains(),
                                found_.blocks, After(move), free, kIterations),
                       move.noise});
      std::snprintf(text, sizeof text, "  %.1f -> %.1f  ", move.score - moves.score,
                    tried.back().fit.score() - found_.score);
      Say(text + Describe(found_.blocks, tried.back().fit.model));
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  }
  std::ranges::sort(tried, {}, [](const Tried& one) { return one.fit.score(); });
  for (const Tried& one : tried) {
    if (one.fit.score() > found_.score - kLeastGain) break;
    try {
      Settled settled = Settle(one.fit, moves.noises[one.noise]);
      std::snprintf(text, sizeof text, "  filtered: %.1f",
                    settled.score() - found_.score);
      Say(text);
      if (settled.score() > found_.score - kLeastGain) continue;
      found_.fit = std::move(settled.fit);
      found_.path = std::move(settled.path);
      found_.score = settled.score();
      return true;
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  }
  return false;
}

Explained Search::Run() {
  found_.path = FilterLikeliest(machine_, run_, reading_sd_);
  found_.nothing = found_.path;
  found_.score = found_.path.deviance;
  std::vector<Candidate> candidates = ListCandidates(machine_);
  BoundByRecord(candidates, machine_, MotionAlong(machine_, run_, found_.path));
  found_.blocks = BlocksOf(machine_, candidates);
  while (!IsOver() && Step()) {
    char text[80];
    std::snprintf(text, sizeof text, "%.1f  ", found_.score);
    Say(text + Describe(found_.blocks, found_.fit.model));
  }
  return std::move(found_);
}

}  // namespace

Explained Explain(const Machine& machine, const MeasuredRun& run,
                  const VectorXd& reading_sd, const ExplainOptions& options) {
  return Search(machine, run, reading_sd, options).Run();
}

}  // namespace mjdiag
