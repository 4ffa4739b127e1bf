#include "mjdiag/discovery/fitting/first_values.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Tries models and keeps the one that leaves the least.
class Trials {
 public:
  Trials(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
         FittedModel model, const MatrixXd* jacobian)
      : problem_(problem.TrainPart()),
        candidates_(candidates),
        best_(std::move(model)) {
    const Index beside = Flatten(best_.causes).size() - Last(best_).value.size();
    if (jacobian == nullptr || jacobian->cols() == 0) return;
    if (jacobian->cols() != best_.numbers.size() + beside) return;
    const Index rows = problem_.run().outputs.size();
    if (jacobian->rows() < rows) return;
    jacobian_ = jacobian->topRows(rows);
  }

  /// The values as they are, and with what is beside the last cause moved.
  void Try(const FittedModel& model) {
    const auto residual = ResidualOf(model);
    if (!residual) return;
    Keep(model, *residual);
    if (jacobian_.cols() == 0) return;
    const FittedModel moved = Moved(model, *residual);
    if (const auto after = ResidualOf(moved)) Keep(moved, *after);
  }
  double least() const { return least_; }
  FittedModel Best() && { return std::move(best_); }

 private:
  static const FittedCause& Last(const FittedModel& model) {
    return model.causes.back();
  }

  std::optional<VectorXd> ResidualOf(const FittedModel& model) const {
    try {
      return problem_.Residual(ChangesOf(problem_, candidates_, model));
    } catch (const NumericalError&) {
      return std::nullopt;
    } catch (const InputError&) {
      return std::nullopt;  // takes away more than there is
    }
  }

  void Keep(const FittedModel& model, const VectorXd& residual) {
    const double left =
        MeanSquare(problem_, residual, problem_.skip(), problem_.train());
    if (!(left < least_)) return;
    least_ = left;
    best_ = model;
  }

  FittedModel Moved(FittedModel model, const VectorXd& residual) const {
    const Index numbers = model.numbers.size();
    const Index first = problem_.run().outputs.rows() * problem_.skip();
    const Index rows = residual.size() - first;
    // Of the other causes next to nothing is known beforehand.
    constexpr double kLittle = 1e-6;
    const VectorXd norms = jacobian_.bottomRows(rows).colwise().norm();
    VectorXd weight = kLittle * norms.cwiseMax(std::numeric_limits<double>::min());
    weight.head(numbers).setConstant(std::sqrt(model.prior_weight));
    MatrixXd A(rows + jacobian_.cols(), jacobian_.cols());
    A << jacobian_.bottomRows(rows), MatrixXd(weight.asDiagonal());
    VectorXd b = VectorXd::Zero(A.rows());
    b.head(rows) = -residual.tail(rows);
    b.segment(rows, numbers) = -weight.head(numbers).cwiseProduct(model.numbers);
    const VectorXd d = LeastSquares(A, b);
    for (Index i = 0; i < numbers; ++i) {
      const DoubtedNumber& number = problem_.numbers()[static_cast<std::size_t>(i)];
      model.numbers[i] =
          std::clamp(model.numbers[i] + d[i], number.Least(), number.Most());
    }
    VectorXd all = Flatten(model.causes);
    all.head(d.size() - numbers) += d.tail(d.size() - numbers);
    model.causes = WithValues(std::move(model.causes), all);
    for (FittedCause& cause : model.causes) cause = Bounded(candidates_, cause);
    return model;
  }

  DiscoveryProblem problem_;
  const std::vector<Candidate>& candidates_;
  MatrixXd jacobian_;
  FittedModel best_;
  double least_ = std::numeric_limits<double>::infinity();
};

/// A share of the sizes of a cause, or of one of them and next to nothing of the others:
/// at nothing at all a fit would not see what they do.
FittedCause ShareOf(const Candidate& candidate, FittedCause cause, double share,
                    Index only) {
  constexpr double kNextToNothing = 0.05;
  for (Index i = 0; i < cause.value.size(); ++i) {
    const FitParameter& parameter = candidate.parameters[static_cast<std::size_t>(i)];
    if (IsShape(parameter.role)) continue;
    const double part = only < 0 || only == i ? share : kNextToNothing * share;
    cause.value[i] = parameter.nothing + part * (cause.value[i] - parameter.nothing);
  }
  return cause;
}

/// Places of the sizes of which each may be nearly all there is; -1: all of them.
std::vector<Index> Parts(const Candidate& candidate) {
  std::vector<Index> places;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    if (!IsShape(candidate.parameters[i].role)) places.push_back(static_cast<Index>(i));
  }
  if (places.size() < 2) places.clear();
  places.insert(places.begin(), -1);
  return places;
}

}  // namespace

FittedModel WithFirstValues(const DiscoveryProblem& problem,
                            const std::vector<Candidate>& candidates, FittedModel model,
                            const MatrixXd* jacobian, double enough) {
  const FittedCause found = model.causes.back();
  const Candidate& candidate = candidates[found.candidate];
  Trials trials(problem, candidates, model, jacobian);
  for (const double share : {1.0, 0.5, 0.2, 0.05}) {
    for (const Index part : Parts(candidate)) {
      model.causes.back() = ShareOf(candidate, found, share, part);
      trials.Try(model);
      if (trials.least() <= enough) return std::move(trials).Best();
    }
  }
  return std::move(trials).Best();
}

}  // namespace mjdiag
