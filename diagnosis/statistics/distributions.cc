#include "mjdiag/diagnosis/statistics/distributions.h"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <limits>

namespace mjdiag {
namespace {

namespace bm = boost::math;
namespace policy = boost::math::policies;

/// NaN and infinity instead of exceptions of Boost's own. In double, which is accurate
/// to the last few bits: Boost's default, long double, takes several times as long.
using Policy = policy::policy<policy::domain_error<policy::ignore_error>,
                              policy::overflow_error<policy::ignore_error>,
                              policy::promote_double<false>,
                              policy::discrete_quantile<policy::integer_round_up>>;

using Normal = bm::normal_distribution<double, Policy>;
using Student = bm::students_t_distribution<double, Policy>;
using ChiSquared = bm::chi_squared_distribution<double, Policy>;
using NoncentralChiSquared = bm::non_central_chi_squared_distribution<double, Policy>;
using FisherF = bm::fisher_f_distribution<double, Policy>;
using Binomial = bm::binomial_distribution<double, Policy>;

}  // namespace

Eigen::VectorXd NormalDensity(const Eigen::VectorXd& x, double mean, double sd) {
  const Normal normal(mean, sd);
  return x.unaryExpr([&](double at) { return bm::pdf(normal, at); });
}

double NormalQuantile(double probability) {
  return bm::quantile(bm::complement(Normal(), probability));
}

double TwoSidedNormalQuantile(double probability) {
  return NormalQuantile(0.5 * probability);
}

double StudentQuantile(double probability, double dof) {
  return bm::quantile(bm::complement(Student(dof), probability));
}

double StudentExceedance(double x, double dof) {
  return bm::cdf(bm::complement(Student(dof), x));
}

double ChiSquaredQuantile(double probability, double dof) {
  return bm::quantile(bm::complement(ChiSquared(dof), probability));
}

double ChiSquaredExceedance(double x, double dof) {
  return bm::cdf(bm::complement(ChiSquared(dof), x));
}

double NoncentralityOf(double x, double dof, double probability) {
  if (!(ChiSquaredExceedance(x, dof) < probability)) return 0.0;
  return NoncentralChiSquared::find_non_centrality(bm::complement(dof, x, probability));
}

double FQuantile(double probability, double dof1, double dof2) {
  // The quantile of Boost's F, but for its warning: there `rest` is not set beforehand.
  double rest = 0.0;
  const double share =
      bm::ibetac_inv(0.5 * dof1, 0.5 * dof2, probability, &rest, Policy());
  return dof2 * share / (dof1 * rest);
}

double FExceedance(double x, double dof1, double dof2) {
  // Boost 1.74 does not look at the second.
  if (!(dof2 > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return bm::cdf(bm::complement(FisherF(dof1, dof2), x));
}

std::pair<int, int> BinomialInterval(int trials, double probability,
                                     double confidence) {
  const Binomial count(trials, probability);
  const double tail = 0.5 * (1.0 - confidence);
  return {static_cast<int>(bm::quantile(count, tail)),
          static_cast<int>(bm::quantile(bm::complement(count, tail)))};
}

std::pair<double, double> ProbabilityInterval(int trials, int successes,
                                              double confidence) {
  // Quantiles of beta distributions.
  const double tail = 0.5 * (1.0 - confidence);
  const double k = successes;
  const double rest = trials - k;
  return {successes == 0 ? 0.0 : bm::ibeta_inv(k, rest + 1.0, tail, Policy()),
          successes == trials ? 1.0 : bm::ibetac_inv(k + 1.0, rest, tail, Policy())};
}

}  // namespace mjdiag
