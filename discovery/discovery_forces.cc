// Machines that leave their rest, along their measured motion (forces/force_search.h): the
// set of laws by the balance of forces, then its values with MuJoCo's own steps.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mjdiag/comparison/force_balance.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/forces/force_search.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The problem with doubts about where masses are, too: a machine that stays at its rest
/// does not show it.
DiscoveryProblem WithCentres(const DiscoveryProblem& problem,
                             const std::vector<PlantNumber>& known) {
  if (problem.numbers().empty()) return problem;
  std::vector<DoubtedNumber> numbers = problem.numbers();
  const mjModel& plant = problem.machine().plant();
  for (const PlantNumber& number : CentreNumbers(plant)) {
    if (std::ranges::find(known, number) != known.end()) continue;
    numbers.push_back({number, DoubtOf(plant, number)});
  }
  return problem.Doubting(std::move(numbers));
}

std::vector<std::vector<Hypothesis>> RivalsIn(const ForceSearchResult& found) {
  std::vector<std::vector<Hypothesis>> rivals;
  for (std::size_t i = 0; i < found.model.causes.size(); ++i) {
    std::vector<Hypothesis>& own = rivals.emplace_back();
    for (const ForceRival& rival : found.rivals[i]) {
      own.push_back({rival.cause, rival.score, 0.0});
    }
    Rank(own);
  }
  return rivals;
}

/// What is left of the balance of forces, whitened, in the place of innovations: of every
/// joint in the row of a sensor, at the samples that count.
class ForceErrors {
 public:
  ForceErrors(const DiscoveryProblem& problem, FilteredRun filtered,
              const ForceSearchResult& found)
      : machine_(problem.machine()),
        filtered_(std::move(filtered)),
        rows_(found.rows),
        noise_(found.noise),
        sd_(problem.observer().innovation_sd) {}

  MatrixXd operator()(const Changes& changes) const {
    const MatrixXd left = BalanceForces(machine_, changes, filtered_).missing;
    return Placed(Whitened(rows_, noise_, RowsOf(rows_, left)).col(0));
  }
  /// Of values of all joints.
  MatrixXd Placed(const VectorXd& white) const {
    MatrixXd errors = MatrixXd::Zero(sd_.size(), filtered_.run.samples());
    for (Index j = 0; j < std::ssize(rows_.dofs); ++j) {
      for (Index k = 0; k < rows_.train; ++k) {
        errors(j, rows_.samples[static_cast<std::size_t>(k)]) =
            sd_[j] * white[j * rows_.values() + k];
      }
    }
    return errors;
  }

 private:
  Machine machine_;
  FilteredRun filtered_;
  ForceRows rows_;
  ForceNoise noise_;
  VectorXd sd_;
};

/// d residual / dz, to first order.
MatrixXd NumbersFirst(const DiscoveryProblem& problem, const ForceErrors& errors,
                      const ForceSearchResult& found) {
  const MatrixXd white = Whitened(found.rows, found.noise, found.numbers);
  MatrixXd J(problem.run().outputs.size(), white.cols());
  for (Index i = 0; i < white.cols(); ++i) {
    // A force that the model has more is one that it lacks less.
    const MatrixXd placed = errors.Placed(-white.col(i));
    const MatrixXd scaled =
        problem.observer().innovation_sd.cwiseInverse().asDiagonal() * placed;
    J.col(i) = VectorXd::Map(scaled.data(), scaled.size());
  }
  return J;
}

/// A law that the steps of the plant cannot follow gives way to the next one that could be
/// in its place, or to none.
void KeepWhatRuns(const DiscoveryProblem& balance,
                  const std::vector<Candidate>& candidates, ForceSearchResult& found) {
  const auto runs = [&](const FittedCause& cause) {
    try {
      balance.Residual(
          ChangesOf(balance, candidates, FittedModel({cause}, found.model.numbers)));
      return true;
    } catch (const NumericalError&) {
      return false;
    } catch (const InputError&) {
      return false;
    }
  };
  for (std::size_t i = found.model.causes.size(); i-- > 0;) {
    FittedCause& cause = found.model.causes[i];
    if (runs(cause)) continue;
    const auto other =
        std::ranges::find_if(found.rivals[i], [&](const ForceRival& rival) {
          return rival.cause.candidate != cause.candidate && runs(rival.cause);
        });
    if (other != found.rivals[i].end()) {
      cause = other->cause;
      continue;
    }
    const auto place = static_cast<std::ptrdiff_t>(i);
    found.model.causes.erase(found.model.causes.begin() + place);
    found.rivals.erase(found.rivals.begin() + place);
    VectorXd loss(found.loss.size() - 1);
    loss << found.loss.head(place), found.loss.tail(found.loss.size() - place - 1);
    found.loss = std::move(loss);
  }
}

/// As closely as the steps of the plant allow; none where they cannot follow.
std::optional<CauseFit> FitAlong(const DiscoveryProblem& balance,
                                 const std::vector<Candidate>& candidates,
                                 const FittedModel& start) {
  auto fit = TryFit(balance, candidates, start,
                    {.iterations = 6,
                     .tolerance = 1e-5,
                     .jacobian = false,
                     .secant = true,
                     .share = balance.work()->Share(1)});
  if (fit) return fit;
  return TryFit(balance, candidates, start,
                {.iterations = 0, .jacobian = false, .closing = true});
}

/// Physics steps in a control tick with which the plant, its numbers as they are found,
/// moves as it does with twice as many: the record would not tell them apart.
int StepsEnough(const DiscoveryProblem& problem, const FilteredRun& filtered,
                const ForceSearchResult& found) {
  constexpr int kMost = 16;      // times those that are given
  constexpr double kTold = 6.0;  // in -2 ln L: odds of 20
  const Machine& machine = problem.machine();
  const int given = machine.rates().substeps;
  const Changes changes = ChangesOf(problem, {}, FittedModel({}, found.model.numbers));
  const auto missing = [&](int substeps) {
    problem.work()->Add(problem.RunWork() * substeps / given);
    return BalanceForces(machine.WithSubsteps(substeps), changes, filtered).missing;
  };
  int substeps = given;
  try {
    MatrixXd coarse = missing(substeps);
    while (2 * substeps <= kMost * given &&
           problem.work()->MayBegin("finer physics steps",
                                    problem.RunWork() * 2 * substeps / given)) {
      MatrixXd fine = missing(2 * substeps);
      const MatrixXd white =
          Whitened(found.rows, found.noise, RowsOf(found.rows, fine - coarse));
      double told = 0.0;
      for (Index j = 0; j < std::ssize(found.rows.dofs); ++j) {
        told += white.col(0)
                    .segment(j * found.rows.values(), found.rows.train)
                    .squaredNorm();
      }
      if (told < kTold) break;
      substeps *= 2;
      coarse = std::move(fine);
    }
  } catch (const NumericalError&) {
    // The plant as it was found cannot follow: it is taken as far as it can.
  }
  return substeps;
}

}  // namespace

bool Discoverer::TakeForces(const SearchOptions& search) {
  if (!GoesAlongMotion() || !work_->MayBegin("laws along the motion")) return false;
  const FilteredRun filtered =
      FilterRun(machine_, problem_.run(), BalanceBandwidth(machine_, problem_.run()));
  ForceBalance nominal = BalanceForces(machine_, {}, filtered);
  problem_ = WithCentres(problem_, KnownNumbers());
  ForceSearchOptions options;
  options.most_causes_a_joint = options_.most_causes;
  options.progress = [this](const std::string& what, double fraction,
                            const std::vector<FittedCause>& causes) {
    CauseFit told;
    told.causes = causes;
    told.train = nominal_;
    Report(what, fraction, told);
  };
  // Laws are looked for with steps that are short enough, which numbers alone tell.
  const int substeps = StepsEnough(
      problem_, filtered, SearchForces(problem_, {}, filtered, nominal, options));
  if (substeps != machine_.rates().substeps) {
    TakeSubsteps(substeps);
    nominal = BalanceForces(machine_, {}, filtered);
  }
  force_ = SearchForces(problem_, candidates_, filtered, nominal, options);
  const ForceErrors errors(problem_, filtered, *force_);
  const DiscoveryProblem balance =
      problem_.Simulating(errors, NumbersFirst(problem_, errors, *force_));
  Report("fit along the motion", 0.5);
  KeepWhatRuns(balance, candidates_, *force_);
  std::optional<CauseFit> fit = FitAlong(balance, candidates_, force_->model);
  auto behind = fit ? TryFit(problem_, candidates_, *fit,
                             {.iterations = 0, .jacobian = false, .closing = true})
                    : std::nullopt;
  if (!behind) {
    force_.reset();
    return false;
  }
  search_.numbers_alone = force_->numbers_alone;
  search_.rivals = RivalsIn(*force_);
  search_.ladder = LadderOf(*fit);
  VectorXd independent = IndependentShare(problem_, behind->residual);
  search_.evidence = {DataOf(problem_, candidates_, search.unseen), std::move(*behind),
                      std::move(independent)};
  search_.significant_rest = true;
  search_.screened = true;
  free_fit_.emplace(balance, std::move(*fit));
  return true;
}

}  // namespace mjdiag
