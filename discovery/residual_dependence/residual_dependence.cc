#include "mjdiag/discovery/residual_dependence/residual_dependence.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "mjdiag/discovery/residual_dependence/curve_shape.h"
#include "mjdiag/discovery/residual_dependence/dependence_search.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kFewestSamples = 400;

bool IsConstant(const VectorXd& x) { return !(x.maxCoeff() > x.minCoeff()); }
bool IsTime(const Variable& variable) { return variable.unit == "s"; }
bool MayBePeriodic(const Variable& variable) {
  return variable.unit == "m" || variable.unit == "rad" || IsTime(variable);
}

/// True if `now` explains more than noise in the shares makes likely.
bool ClearlyBetter(const Explanation& now, const Explanation& best) {
  return now.share > best.share + 0.02 + 0.05 * (1.0 - best.share);
}

void Require(const VectorXd& signal, double signal_sd,
             const std::vector<Variable>& variables) {
  if (signal.size() < kFewestSamples || !signal.allFinite()) {
    throw InputError("signature", std::to_string(signal.size()) + " samples",
                     "at least " + std::to_string(kFewestSamples) + " finite ones");
  }
  if (!(signal_sd > 0.0)) throw InputError("signature", "no noise", "a noise sd > 0");
  for (const Variable& variable : variables) {
    if (variable.value.size() != signal.size() || !variable.value.allFinite()) {
      throw InputError("signature", "variable '" + variable.name + "'",
                       "finite values, one for every sample of the signal");
    }
  }
}

/// The best explanation first, then the best of other variables without a factor.
std::vector<Explanation> Rank(const ResidualDependenceSearch& search,
                              const std::vector<Variable>& variables) {
  std::vector<Explanation> plain{{}};
  std::vector<Explanation> special;
  Explanation over_time;
  for (const Variable& x : variables) {
    if (IsConstant(x.value)) continue;
    if (IsTime(x)) {
      over_time = search.OverTime(x);
      special.push_back(search.Sine(x));
      continue;
    }
    plain.push_back(search.Binned(x, nullptr));
    if (MayBePeriodic(x)) special.push_back(search.Sine(x));
    for (const Variable& m : variables) {
      if (m.is_factor && &m != &x) special.push_back(search.Binned(x, &m));
    }
  }
  std::erase_if(plain, [](const Explanation& e) {
    return e.variable != nullptr && !e.significant;
  });
  std::erase_if(special, [](const Explanation& e) { return !e.significant; });
  const auto by_share = [](const Explanation& a, const Explanation& b) {
    return a.share > b.share;
  };
  std::stable_sort(plain.begin(), plain.end(), by_share);
  std::stable_sort(special.begin(), special.end(), by_share);
  // A step between a few values rather than a curve that does the same.
  const double enough = plain[0].share - 0.005 - 0.02 * (1.0 - plain[0].share);
  const auto simple = std::find_if(plain.begin(), plain.end(), [&](const auto& e) {
    return e.simple && e.share >= enough;
  });
  if (simple != plain.end()) std::rotate(plain.begin(), simple, simple + 1);
  if (!special.empty() && ClearlyBetter(special[0], plain[0])) {
    plain.insert(plain.begin(), special[0]);
  }
  if (over_time.significant && plain[0].share < 0.5 * over_time.share) {
    plain.insert(plain.begin(), over_time);
  }
  return plain;
}

std::string Percent(double share) {
  return std::to_string(std::lround(100.0 * share)) + " %";
}

}  // namespace

ResidualDependence FindResidualDependence(const std::string& site,
                                          const VectorXd& signal,
                                          const std::string& signal_unit,
                                          double signal_sd,
                                          const std::vector<Variable>& variables) {
  Require(signal, signal_sd, variables);
  const auto factors =
      static_cast<double>(std::count_if(variables.begin(), variables.end(),
                                        [](const Variable& v) { return v.is_factor; }));
  const double tests = (2.0 + factors) * static_cast<double>(variables.size()) + 1.0;
  ResidualDependence result;
  result.site = site;
  result.shape = "none";
  if (IsConstant(signal) && signal[0] == 0.0) {
    result.text = site + ": nothing is left to explain";
    return result;
  }
  const double rms =
      std::sqrt(signal.squaredNorm() / static_cast<double>(signal.size()));
  std::ostringstream text;
  text.precision(3);
  text << site << ": of " << rms << ' ' << signal_unit << " rms ";
  const ResidualDependenceSearch search(signal, signal_sd, tests);
  std::vector<Explanation> ranked{{}};
  if (!IsConstant(signal)) ranked = Rank(search, variables);
  const Explanation& best = ranked[0];
  if (best.variable == nullptr) {
    result.significant = search.HasMean();
    if (result.significant) {
      const double share = signal.mean() / rms;
      result.shape = "constant";
      result.explained_share = share * share;
      text << Percent(result.explained_share) << " is a constant " << signal.mean()
           << ' ' << signal_unit;
    } else {
      text << "none depends on any of " << variables.size() << " variables";
    }
    result.text = text.str();
    return result;
  }
  const CurveShape shape =
      DescribeCurve(best.x, best.y, best.y_sd, best.variable->unit);
  result.variable = best.variable->name;
  result.unit = best.variable->unit;
  if (best.factor != nullptr) result.factor = best.factor->name;
  result.shape = shape.words;
  result.period = shape.period;
  result.exponent = shape.exponent;
  result.explained_share = best.share;
  result.significant = true;
  result.x = best.x;
  result.y = best.y;
  result.y_sd = best.y_sd;
  if (best.period > 0.0) {
    std::ostringstream words;
    words.precision(4);
    words << "periodic, period " << best.period << ' ' << result.unit;
    if (IsTime(*best.variable)) words << " (" << 1.0 / best.period << " Hz)";
    result.shape = words.str();
    result.period = best.period;
    result.exponent = 0.0;
  }
  text << Percent(best.share) << " follows " << result.variable;
  if (best.factor != nullptr) text << " times " << result.factor;
  text << " (" << result.shape << ')';
  for (const Explanation& other : ranked) {
    if (other.variable == nullptr || other.variable == best.variable) continue;
    result.runner_up = other.variable->name;
    result.runner_up_share = other.share;
    text << "; next " << result.runner_up << " with " << Percent(other.share);
    break;
  }
  result.text = text.str();
  return result;
}

}  // namespace mjdiag
