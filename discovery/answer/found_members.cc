#include "mjdiag/discovery/answer/found_members.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/hypotheses/fitted_cause.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// What is less probable is not told.
constexpr double kLeastAlternative = 0.01;
constexpr double kLeastKind = 0.05;

struct Span {
  double sd = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Of a value, from what is known of its coordinate.
Span SpanOf(const Coordinate& coordinate, double value, double sd) {
  const double x = coordinate.ToX(value);
  const double half = TwoSidedNormalQuantile(0.05) * sd;
  const auto theta = [&](double at) {
    return coordinate.ToTheta(std::clamp(at, coordinate.lower, coordinate.upper));
  };
  const double rate = coordinate.is_log ? value * coordinate.unit : coordinate.unit;
  return {std::abs(rate) * sd, std::min(value, theta(x - half)),
          std::max(value, theta(x + half))};
}

/// Of every value of a member; of choices, which no fit changes, itself.
std::vector<Span> SpansOfMember(const std::vector<Coordinate>& coordinates,
                                const Model& model, std::size_t member,
                                const VectorXd& sd) {
  std::vector<Span> spans;
  for (const double value : model[member].values) spans.push_back({0.0, value, value});
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const Coordinate& one = coordinates[i];
    if (one.member != member) continue;
    spans[static_cast<std::size_t>(one.value)] =
        SpanOf(one, model[member].values[one.value], sd[static_cast<Index>(i)]);
  }
  return spans;
}

std::vector<CauseParameter> ParametersOfCause(const mjModel& plant,
                                              const Candidate& candidate,
                                              const VectorXd& values,
                                              const std::vector<Span>& spans) {
  std::vector<CauseParameter> parameters;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    const EffectParameter& parameter =
        candidate.effect
            ->parameters()[static_cast<std::size_t>(candidate.chosen.size()) + i];
    parameters.push_back(
        {parameter.name, SiteUnit(plant, *candidate.effect, candidate.site, parameter),
         values[static_cast<Index>(i)], spans[i].sd, spans[i].low, spans[i].high});
  }
  return parameters;
}

Cause CauseOfBlock(const Block& block, const VectorXd& values) {
  return CauseOf({*block.candidate}, {0, values});
}

CalibratedNumber NumberOf(const mjModel& plant, const Block& block, double factor,
                          const Span& span) {
  const ModelParameter& number = *block.number;
  return {block.name,
          number,
          factor,
          span.low,
          span.high,
          block.doubt,
          IsAdditive(number.kind) ? UnitOf(plant, number) : 0.0,
          UnitName(plant, number)};
}

std::pair<Kind, std::string> KindOfBlock(const Block& block, const VectorXd& values) {
  if (block.candidate && IsCurve(*block.candidate)) {
    return {KindOfCurve(CauseOfBlock(block, values).values, block.candidate->joint),
            block.candidate->site};
  }
  if (block.candidate) return {block.candidate->effect->kind(), block.candidate->site};
  return {KindOf(block.number->kind), block.name.substr(block.name.find('@') + 1)};
}

struct KindSum {
  double none = 1.0;  ///< that it is at none of the places
  double loss = 0.0;  ///< of unseen data without the members of that kind
  bool is_member = false;
  bool only_numbers = true;
};

}  // namespace

CoordinateErrors CoordinateErrorsOf(const AnswerData& data, const ModelOnRuns& answer) {
  constexpr int kFolds = 20;
  constexpr double kStep = 1e-3;
  const ModelFit& fit = answer.fit;
  const auto coordinates = CoordinatesOf(data.blocks, fit.model);
  const VectorXd x = Place(coordinates, fit.model);
  const CoordinateErrors of_fit{fit.sd, MatrixXd::Identity(x.size(), x.size())};
  if (x.size() == 0) return of_fit;
  const KeptGains gains = KeepGains(answer.seen);
  const auto run_at = [&](const VectorXd& at) {
    return PredictAlong(data.With(At(coordinates, fit.model, at)), data.run.seen,
                        answer.seen, gains);
  };
  VectorXd left;
  MatrixXd J;
  try {
    left = run_at(x);
    J.resize(left.size(), x.size());
    ParallelForAll(static_cast<int>(x.size()), [&](int number) {
      const Index i = number;
      const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
      double step = kStep * std::max(1.0, std::abs(x[i]));
      if (one.is_log) step = kStep;
      if (x[i] + step > one.upper) step = -step;
      VectorXd moved = x;
      moved[i] += step;
      J.col(i) = (run_at(moved) - left) / step;
    });
  } catch (const NumericalError&) {
    return of_fit;
  }
  MatrixXd H = J.transpose() * J + MatrixXd::Identity(x.size(), x.size());
  const Eigen::LLT<MatrixXd> solved(H);
  // Not the fit's own: units of what has no spread go with the value (model.h), which was
  // another one where the fit began.
  const MatrixXd within = solved.solve(MatrixXd::Identity(x.size(), x.size()));
  MatrixXd between = MatrixXd::Zero(x.size(), x.size());
  for (Index f = 0; f < kFolds; ++f) {
    const Index first = left.size() * f / kFolds;
    const Index rows = left.size() * (f + 1) / kFolds - first;
    const VectorXd g =
        J.middleRows(first, rows).transpose() * left.segment(first, rows);
    between += g * g.transpose();
  }
  between *= static_cast<double>(kFolds) / (kFolds - 1);
  const MatrixXd root = solved.solve(between);
  const MatrixXd covariance = solved.solve(root.transpose());
  const VectorXd scale = within.diagonal().cwiseSqrt().cwiseInverse();
  return {within.diagonal().cwiseMax(covariance.diagonal()).cwiseSqrt(),
          scale.asDiagonal() * within * scale.asDiagonal()};
}

void AddMembers(const AnswerData& data, const UnseenJudgement& judged,
                const std::vector<MemberPosterior>& posterior, const VectorXd& sd,
                Discovery& discovery) {
  const mjModel& plant = data.machine.plant();
  const Model& model = judged.answer.fit.model;
  const auto coordinates = CoordinatesOf(data.blocks, model);
  std::map<std::pair<Kind, std::string>, KindSum> kinds;
  for (std::size_t m = 0; m < model.size(); ++m) {
    const Block& block = data.blocks[model[m].block];
    const VectorXd& values = model[m].values;
    const MemberPosterior& said = posterior[m];
    const std::vector<Span> spans = SpansOfMember(coordinates, model, m, sd);
    // Of one place, the kinds of all that could be there.
    std::map<std::pair<Kind, std::string>, double> here;
    here[KindOfBlock(block, values)] += said.probability;
    KindSum& own = kinds[KindOfBlock(block, values)];
    own.is_member = true;
    own.only_numbers = own.only_numbers && block.number.has_value();
    own.loss += judged.losses[m].unseen;
    for (const Rival& rival : said.rivals) {
      here[KindOfBlock(data.blocks[rival.block], rival.values)] += rival.probability;
    }
    for (const auto& [kind, probability] : here) kinds[kind].none *= 1.0 - probability;
    if (block.number) {
      discovery.calibration.push_back(NumberOf(plant, block, values[0], spans[0]));
      discovery.calibration.back().is_found = true;
      continue;
    }
    FoundCause found;
    found.cause = CauseOfBlock(block, values);
    found.parameters = ParametersOfCause(plant, *block.candidate, values, spans);
    if (IsCurve(*block.candidate)) {
      found.unnamed = "a force over the " + CurveVariableName(plant, *block.candidate);
    }
    found.probability = said.probability;
    found.none = said.none;
    for (const Rival& rival : said.rivals) {
      if (rival.probability < kLeastAlternative) break;
      const Block& other = data.blocks[rival.block];
      if (other.candidate) {
        found.alternatives.push_back(
            {CauseOfBlock(other, rival.values), rival.probability, false});
      } else {
        found.numbers.push_back({other.name, rival.probability});
      }
    }
    for (const Cause& twin : EquivalentCauses(plant, found.cause)) {
      found.alternatives.insert(found.alternatives.begin(),
                                {twin, found.probability, true});
    }
    discovery.causes.push_back(std::move(found));
  }
  const double gained = judged.nothing.unseen_deviance - judged.answer.unseen_deviance;
  for (const auto& [of, sum] : kinds) {
    const double probability = 1.0 - sum.none;
    if (probability < kLeastKind) continue;
    const double share =
        sum.is_member && gained > 0.0 ? std::clamp(sum.loss / gained, 0.0, 1.0) : 0.0;
    discovery.kinds.push_back(
        {of.first, of.second, probability, share, sum.is_member && sum.only_numbers});
  }
  // What is certain by what it is worth: nobody tells 99.95 % from 99.99 %.
  constexpr double kCertain = 0.999;
  std::ranges::stable_sort(
      discovery.kinds, std::greater<>(), [&](const FoundKind& one) {
        return std::pair(std::min(one.probability, kCertain), one.share);
      });
}

}  // namespace mjdiag
