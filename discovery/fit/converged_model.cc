#include "mjdiag/discovery/fit/converged_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/discovery/fit/pruned_fit.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

class Settling {
 public:
  /// @param beat  a score
  Settling(const ConvergedBeside& beside, ModelFit fit, std::vector<FilterNoise> near,
           double beat)
      : beside_(beside),
        near_(std::move(near)),
        beat_(beat),
        settled_{std::move(fit), {}} {
    settled_.path.deviance = std::numeric_limits<double>::infinity();
  }

  const ConvergedModel& settled() const { return settled_; }
  bool is_likeliest() const { return is_likeliest_; }
  bool IsNowhere() const { return !std::isfinite(settled_.path.deviance); }

  /// Behind the noise of the model so far, whose likelihood everything is compared with.
  /// @param hopeless  above that it is none
  void Begin(double hopeless) {
    for (const FilterNoise& noise : near_) {
      try {
        Follow(settled_.fit, noise);
      } catch (const NumericalError&) {
      }
    }
    if (IsNowhere()) Relax();
    if (settled_.score() > hopeless) {
      is_likeliest_ = true;  // what is so far off is not worth it
    }
  }
  void BeginWith(FilterPath path) {
    settled_.path = std::move(path);
    RefitAsLongAsItGains();
  }

  /// Behind a noise that suits another model better: with the values that suit it there.
  void Try(const FilterNoise& noise) {
    ConvergedModel before = settled_;
    try {
      settled_ = Followed(before.fit, noise);
      Gains(noise, false);
    } catch (const NumericalError&) {
    }
    if (settled_.score() < before.score() - LeastGain()) {
      is_likeliest_ = false;
      round_ = 0;
    } else {
      settled_ = std::move(before);
    }
  }

  /// A fit and then a noise, and before the first a noise; it is likeliest where the fit gains
  /// nothing.
  void Round() {
    // Values that are off make latent forces large, behind which values are hardly seen:
    // where fits behind the noise of the last filter gain no more, one behind a smaller may.
    constexpr std::size_t kSmaller = 2;  // of NoisesFrom
    const double before = settled_.score();
    is_likeliest_ = true;
    if (round_ == 0) Relax();
    if (IsDone() || ++round_ > kRounds) return;
    const std::vector<FilterNoise> noises = NoisesFrom(settled_.path.noise);
    is_likeliest_ = !Gains(noises.front(), true) &&
                    !(beside_.is_last && Gains(noises[kSmaller], true));
    if (!is_likeliest_ && !beside_.is_over()) Relax();
    gained_ = before - settled_.score();
  }

  /// Whether it may come out better than another: by two rounds like the last. The best one
  /// may, also where its last round lost: how well values are known is told anew by each.
  /// @param hoped  of the first
  bool MayReach(double score, double hoped) const {
    const double gain = round_ == 0 ? hoped : 2.0 * std::max(0.0, gained_);
    return !is_likeliest_ && settled_.score() - gain <= score;
  }

  /// The noise that suits the model by now.
  void Relax() {
    const Machine machine = beside_.machine_with(settled_.fit.model);
    const bool is_near = near_.empty() || !IsNowhere();
    FilterPath path =
        is_near ? FilterLikelier(machine, beside_.run, beside_.reading_sd,
                                 settled_.path, beside_.is_over,
                                 beside_.is_last ? kMostReadings : kFewReadings)
                : FilterLikeliestFrom(machine, beside_.run, beside_.reading_sd,
                                      beside_.dofs, near_, beside_.is_over);
    near_.clear();
    Take({settled_.fit, std::move(path)});
  }

 private:
  static constexpr int kRounds = 6;

  /// A round that gains less is the last.
  double LeastGain() const {
    constexpr double kShare = 0.01;
    constexpr double kMost = 10.0;  // e^-5 as likely
    if (beside_.is_last || !std::isfinite(settled_.path.deviance)) return kLeastGain;
    return std::clamp(kShare * (beat_ - settled_.score()), kLeastGain, kMost);
  }

  bool IsDone() const { return settled_.fit.model.empty() || beside_.is_over(); }

  void RefitAsLongAsItGains() {
    for (int round = 0; round < kRounds && !IsDone(); ++round) {
      if (!Gains(settled_.path.noise, false)) return;
    }
  }

  /// Refit, and whether that gains.
  bool Gains(const FilterNoise& noise, bool prunes) {
    try {
      return Refit(noise, prunes);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
    return false;
  }

  ConvergedModel Followed(ModelFit fit, const FilterNoise& noise) const {
    const Machine machine = beside_.machine_with(fit.model);
    return {
        std::move(fit),
        RunForceFilter(machine, beside_.run, beside_.dofs,
                       FilterStarts(machine, beside_.run, beside_.reading_sd), noise)};
  }

  /// Takes what is better behind a noise.
  void Follow(ModelFit fit, const FilterNoise& noise) {
    Take(Followed(std::move(fit), noise));
  }

  void Take(ConvergedModel other) {
    if (other.score() < settled_.score()) settled_ = std::move(other);
  }

  /// Fits the model behind a noise, with the gains of its path.
  /// @param prunes  whether members that are worth less than they cost leave: not before the
  ///                noise is that of the model, for a latent force that is as large as what a
  ///                member does, and lasts, does it as well
  bool Refit(const FilterNoise& noise, bool prunes) {
    constexpr int kFitIterations = 4;
    constexpr double kPart = 0.1;
    const FilterNoise of_path = settled_.path.noise;
    const KeptGains gains =
        KeepGains(settled_.path, noise, OverdispersionAlong(settled_.path));
    const MachineWith in_time = InTime(beside_.machine_with, beside_.is_over);
    const FitOf fitted = [&](const Model& start) {
      return FitModel(in_time, beside_.run, settled_.path, gains, beside_.blocks, start,
                      {kFitIterations, kPart * LeastGain()});
    };
    ModelFit next = fitted(settled_.fit.model);
    if (prunes) next = Pruned(beside_.blocks, std::move(next), fitted);
    const bool is_same = next.model.size() == settled_.fit.model.size();
    // How well values are known, which costs, is told behind the noise of the path.
    const bool is_own = noise.size == of_path.size;
    if (is_same) {
      ModelFit& from = is_own ? next : settled_.fit;
      ModelFit& to = is_own ? settled_.fit : next;
      to.sd = from.sd;
      to.occam = from.occam;
    }
    // Where a fit gains nothing behind the gains that it was made behind, a filter, which
    // takes longer, need not be asked.
    const double before =
        gains.left.squaredNorm() + gains.log_determinant + settled_.fit.prior;
    if (is_same && before - next.deviance - next.prior < LeastGain()) return false;
    const double score = settled_.score();
    Follow(next, of_path);
    if (!is_own) Follow(next, noise);
    return settled_.score() < score - LeastGain();
  }

  const ConvergedBeside& beside_;
  std::vector<FilterNoise> near_;  // until they have been asked
  double beat_;
  ConvergedModel settled_;
  bool is_likeliest_ = false;  // no noise is known that suits it better
  int round_ = 0;
  double gained_ = 0.0;  // by the last round
};

const Settling& Best(const std::vector<Settling>& rivals) {
  return *std::ranges::min_element(
      rivals, {}, [](const Settling& one) { return one.settled().score(); });
}

}  // namespace

std::vector<std::optional<ConvergedModel>> SettleRivals(
    const ConvergedBeside& beside, std::vector<ModelFit> fits,
    const std::vector<FilterNoise>& near, double beat, double hoped) {
  // Values of first order are off, and what sticks by them a fit may free; what is so much
  // further off than it was to gain is nonsense.
  constexpr double kNonsense = 300.0;
  const double hopeless = beat + kNonsense * std::max(hoped, kLeastGain);
  std::vector<Settling> rivals;
  for (ModelFit& fit : fits) rivals.emplace_back(beside, std::move(fit), near, beat);
  const auto each = [&](const auto& work) {
    ParallelForAll(static_cast<int>(rivals.size()), [&](int number) {
      try {
        work(rivals[static_cast<std::size_t>(number)]);
      } catch (const NumericalError&) {
      } catch (const InputError&) {
      }
    });
  };
  each([&](Settling& one) { one.Begin(hopeless); });
  while (!rivals.empty() && !beside.is_over()) {
    const Settling& best = Best(rivals);
    if (best.IsNowhere()) break;
    if (!best.is_likeliest()) {
      // Noises gain as much as laws do, and what is large is nothing behind the noise of the
      // machine without it: whoever may come out best is asked at once.
      constexpr double kMay = 0.5;  // of what the best gains
      const double score = best.settled().score();
      const double may = std::max(kMay * std::max(0.0, beat - score), hoped);
      each([&](Settling& one) {
        if (one.MayReach(score, may)) one.Round();
      });
      continue;
    }
    each([&](Settling& one) {
      if (&one != &best && !one.IsNowhere()) one.Try(best.settled().path.noise);
    });
    if (Best(rivals).is_likeliest()) break;
  }
  std::vector<std::optional<ConvergedModel>> settled;
  for (const Settling& one : rivals) {
    settled.emplace_back();
    if (!one.IsNowhere()) settled.back() = one.settled();
  }
  return settled;
}

std::vector<std::optional<ConvergedModel>> SettleInPlaceOf(
    const ConvergedModel& found, const ConvergedBeside& beside,
    const std::vector<Model>& models, double hoped) {
  const KeptGains gains = KeepGains(found.path);
  std::vector<std::optional<ModelFit>> fitted(models.size());
  ParallelForAll(static_cast<int>(models.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    try {
      fitted[i] = FitModel(beside.machine_with, beside.run, found.path, gains,
                           beside.blocks, models[i], {});
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  });
  std::vector<ModelFit> fits;
  for (std::optional<ModelFit>& one : fitted) {
    if (one) fits.push_back(std::move(*one));
  }
  return SettleRivals(beside, std::move(fits), {found.path.noise}, found.score(),
                      hoped);
}

ConvergedModel SettleNear(const ConvergedBeside& beside, ModelFit fit,
                          FilterPath path) {
  const double beat = ConvergedModel{fit, path}.score();
  Settling one(beside, std::move(fit), {}, beat);
  one.BeginWith(std::move(path));
  one.Relax();
  return one.settled();
}

ConvergedModel Settle(const ConvergedBeside& beside, ModelFit fit,
                      const std::vector<FilterNoise>& near, double beat, double hoped) {
  std::vector<ModelFit> fits;
  fits.push_back(std::move(fit));
  auto settled = SettleRivals(beside, std::move(fits), near, beat, hoped);
  if (!settled.front()) throw NumericalError("fit: the run diverges");
  return std::move(*settled.front());
}

}  // namespace mjdiag
