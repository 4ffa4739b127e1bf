#include "mjdiag/plugin/effects/friction/stribeck_curve.h"

#include <cmath>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {

double StribeckShare(double v, double velocity) noexcept {
  const double ratio = v / velocity;
  return std::exp(-ratio * ratio);
}

std::vector<CandidateRegressor> StribeckRegressors(const SiteMotion& at,
                                                   const Eigen::VectorXd& slide) {
  const Eigen::VectorXd v = at.v();
  const double top = v.cwiseAbs().maxCoeff();
  std::vector<CandidateRegressor> trials;
  for (const double velocity : LogGrid(0.003 * top, 0.6 * top, 7)) {
    Eigen::MatrixXd parts(v.size(), 2);
    parts.col(0) = slide;
    parts.col(1) = slide.array() * (-(v.array() / velocity).square()).exp();
    trials.push_back({parts, at.JointEntry(2),
                      [velocity](const Amplitudes& a) -> RegressorValues {
                        if (a[1] <= 0.0) return std::nullopt;
                        return ValuesOf({a[0], a[1], velocity});
                      },
                      Amplitudes::Zero(2)});
  }
  return trials;
}

}  // namespace mjdiag
