#include "mjdiag/discovery/residual_dependence/curve_shape.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string Short(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
}

class Chooser {
 public:
  Chooser(const VectorXd& x, const VectorXd& y, const VectorXd& sd)
      : x_(x), weight_(sd.cwiseInverse()), y_(y.cwiseProduct(weight_)) {
    constant_ = ResidualOf({});
  }

  const ArrayXd& x() const { return x_; }
  ArrayXd sign() const { return x_.sign(); }

  /// @param columns     of the form beside the constant
  /// @param parameters  nonlinear ones
  void Try(const std::vector<ArrayXd>& columns, int parameters, CurveShape shape) {
    const auto n = static_cast<double>(x_.size());
    const double linear = 1.0 + static_cast<double>(columns.size());
    if (linear + parameters >= n && !columns.empty()) return;
    const double residual = ResidualOf(columns);
    const double score =
        n * std::log(std::max({residual / n, 1.0, 0.01 * constant_ / n})) +
        (linear + parameters) * std::log(n);
    // Of forms that are equally good by that, the closest.
    if (score < score_ || (score == score_ && residual < least_residual_)) {
      score_ = score;
      least_residual_ = residual;
      best_ = std::move(shape);
    }
  }

  CurveShape best() const {
    const auto n = static_cast<double>(x_.size());
    // Four times the noise and a fifth of the curve left over: not described.
    if (least_residual_ > 4.0 * n && least_residual_ > 0.2 * constant_) {
      return {"no simple form"};
    }
    return best_;
  }

 private:
  double ResidualOf(const std::vector<ArrayXd>& columns) const {
    MatrixXd design(x_.size(), static_cast<Index>(columns.size()) + 1);
    design.col(0) = weight_;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      design.col(static_cast<Index>(i) + 1) = columns[i] * weight_.array();
    }
    return (y_ - design * LeastSquares(design, y_)).squaredNorm();
  }

  ArrayXd x_;
  VectorXd weight_;
  VectorXd y_;
  double constant_ = 0.0;
  double least_residual_ = 0.0;
  double score_ = std::numeric_limits<double>::infinity();
  CurveShape best_;
};

void TryBothSigns(Chooser& chooser) {
  const ArrayXd sign = chooser.sign();
  const ArrayXd size = chooser.x() / chooser.x().abs().maxCoeff();
  chooser.Try({sign}, 0, {"step at zero"});
  chooser.Try({sign, size}, 0, {"step at zero plus linear"});
  for (double p = 0.5; p < 4.1; p += 0.125) {
    const ArrayXd power = size.abs().pow(p);
    const std::string even =
        p == 2.0 ? "quadratic, even" : "even, power " + Short(p) + " of the magnitude";
    chooser.Try({power}, 1, {even, 0.0, p});
    if (p == 1.0) continue;
    const std::string odd =
        p == 3.0 ? "cubic, odd" : "odd, power " + Short(p) + " of the magnitude";
    chooser.Try({sign * power}, 1, {odd, 0.0, p});
  }
  for (double w = 0.03; w < 0.8; w *= 1.3) {
    chooser.Try({(size / w).tanh()}, 1, {"saturating, odd"});
  }
}

void TryOneSided(Chooser& chooser, const std::string& unit) {
  const ArrayXd& x = chooser.x();
  const Index n = x.size();
  for (Index i = 2; i + 2 < n; ++i) {
    const std::string beyond = Short(x[i]) + " " + unit;
    chooser.Try({(x - x[i]).max(0.0)}, 1, {"one-sided, rising above " + beyond});
    chooser.Try({(x[i] - x).max(0.0)}, 1, {"one-sided, rising below " + beyond});
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = i + 1; j < n; ++j) {
      const bool ends = i == 0 || j == n - 1;
      const ArrayXd inside = (x >= x[i] && x <= x[j]).cast<double>();
      chooser.Try(
          {inside}, ends ? 1 : 2,
          {"different between " + Short(x[i]) + " and " + Short(x[j]) + " " + unit});
    }
  }
}

void TryPeriodic(Chooser& chooser, const std::string& unit) {
  const ArrayXd& x = chooser.x();
  const Index n = x.size();
  const double range = x[n - 1] - x[0];
  for (double cycles = 0.7; cycles < static_cast<double>(n) / 4.0; cycles += 0.05) {
    const double period = range / cycles;
    const ArrayXd phase = 2.0 * std::numbers::pi * x / period;
    std::string words = "periodic, period " + Short(period) + " " + unit;
    if (unit == "s") words += " (" + Short(1.0 / period) + " Hz)";
    chooser.Try({phase.sin(), phase.cos()}, 1, {words, period});
  }
}

}  // namespace

CurveShape DescribeCurve(const VectorXd& x, const VectorXd& y, const VectorXd& sd,
                         const std::string& unit) {
  Chooser chooser(x, y, sd);
  chooser.Try({}, 0, {"constant"});
  if (x.size() <= 3) {
    if (x.size() > 1) chooser.Try({chooser.sign()}, -1, {"step at zero"});
    return chooser.best();
  }
  const double centre = 0.5 * (x.maxCoeff() + x.minCoeff());
  const double half = 0.5 * (x.maxCoeff() - x.minCoeff());
  const ArrayXd u = (chooser.x() - centre) / half;
  chooser.Try({u}, 0, {"linear"});
  chooser.Try({u, u.square()}, 0, {"quadratic"});
  chooser.Try({u, u.square(), u.cube()}, 0, {"cubic"});
  if (x.minCoeff() < 0.0 && x.maxCoeff() > 0.0) TryBothSigns(chooser);
  TryOneSided(chooser, unit);
  TryPeriodic(chooser, unit);
  return chooser.best();
}

}  // namespace mjdiag
