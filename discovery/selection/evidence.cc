#include "mjdiag/discovery/selection/evidence.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

VectorXd Count(const EvidenceData::Counts& counts, Index first, Index last) {
  return counts ? counts(first, last) : VectorXd();
}

}  // namespace

EvidenceData DataOf(const DiscoveryProblem& problem,
                    const std::vector<Candidate>& candidates, const MeasuredRun* unseen,
                    const std::function<double(const Changes&)>& free_run) {
  EvidenceData data;
  data.skip = problem.skip();
  data.train = problem.train();
  data.samples = problem.run().samples();
  // The run outlives copies of the problem.
  data.measured = [run = problem](Index first, Index last) {
    return run.Measured(first, last);
  };
  if (free_run) {
    data.free_run = [&problem, &candidates, free_run](const FittedModel& model) {
      return free_run(ChangesOf(problem, candidates, model));
    };
  }
  if (unseen == nullptr) return data;
  const auto other = std::make_shared<const DiscoveryProblem>(problem.WithRun(*unseen));
  data.replay = [other, &candidates](const FittedModel& model) {
    try {
      return other->Residual(ChangesOf(*other, candidates, model));
    } catch (const NumericalError&) {
      return VectorXd();
    }
  };
  data.replay_measured = [other](Index first, Index last) {
    return other->Measured(first, last);
  };
  return data;
}

double Evidence::Criterion(const VectorXd& independent) const {
  return mjdiag::Criterion(fit_, independent, data_.skip, data_.train,
                           Count(data_.measured, data_.skip, data_.train));
}

const VectorXd& Evidence::Replayed() const {
  if (!replayed_) replayed_ = data_.replay ? data_.replay(fit_) : VectorXd();
  return *replayed_;
}

double Evidence::Unseen(const VectorXd& independent) const {
  const double held_out =
      data_.train < data_.samples
          ? Deviance(fit_.residual, independent, data_.train, data_.samples,
                     Count(data_.measured, data_.train, data_.samples))
          : 0.0;
  if (!data_.replay) return held_out;
  const VectorXd& replayed = Replayed();
  if (replayed.size() == 0) return std::numeric_limits<double>::infinity();
  const Index samples = replayed.size() / independent.size();
  return held_out + Deviance(replayed, independent, data_.skip, samples,
                             Count(data_.replay_measured, data_.skip, samples));
}

double Evidence::UnseenSquares() const {
  const Eigen::Index channels = independent_.size();
  const auto from = [&](const VectorXd& residual, Index first) {
    return residual.tail(residual.size() - channels * first).squaredNorm();
  };
  const double held_out = from(fit_.residual, data_.train);
  if (!data_.replay) return held_out;
  const VectorXd& replayed = Replayed();
  if (replayed.size() == 0) return std::numeric_limits<double>::infinity();
  return held_out + from(replayed, data_.skip);
}

double Evidence::FreeRun() const {
  if (!data_.free_run) return 0.0;
  if (!free_run_) free_run_ = data_.free_run(fit_);
  return *free_run_;
}

double Evidence::Inflation(const VectorXd& independent) const {
  return mjdiag::Inflation(fit_.train, independent);
}

double Evidence::Noise() const {
  const VectorXd measured = Count(data_.measured, data_.skip, data_.train);
  if (measured.size() > 0) return measured.sum();
  return static_cast<double>(independent_.size() * (data_.train - data_.skip));
}

Significance Evidence::SignificanceOf(double gain, int freedom, const Chance& chance,
                                      const VectorXd& independent) const {
  return {(gain - chance.unsteadiness) / Inflation(independent),
          GainByChance(chance.probability, chance.trials, freedom)};
}

Significance Evidence::SignificanceOf(const CauseFit& after, const Chance& chance,
                                      const VectorXd& independent) const {
  return SignificanceOf(Noise() * (fit_.train - after.train) +
                            fit_.prior_weight * (fit_.prior - after.prior),
                        ParameterCount({after.causes.back()}), chance, independent);
}

Evidence Evidence::Added(CauseFit fit, VectorXd independent,
                         const Chance& chance) const {
  const Significance addition = SignificanceOf(fit, chance, independent);
  return {data_, std::move(fit), std::move(independent), addition};
}

}  // namespace mjdiag
