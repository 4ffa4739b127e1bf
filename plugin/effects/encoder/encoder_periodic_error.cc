// The reading plus amplitude sin(2 pi reading / period + phase).

#include <cmath>
#include <numbers>

#include "mjdiag/plugin/effects/encoder/reading_error.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/effects/wave.h"

namespace mjdiag {
namespace {

/// The readings at samples as their neighbours have them, two on either side: what is
/// made of a reading and compared with its own innovation must not hold its noise.
Eigen::VectorXd WithoutOwnNoise(const Eigen::VectorXd& y) {
  const Eigen::Index n = y.size();
  Eigen::VectorXd x = y;
  for (Eigen::Index k = 2; k + 2 < n; ++k) {
    x[k] = (4.0 * (y[k - 1] + y[k + 1]) - y[k - 2] - y[k + 2]) / 6.0;
  }
  return x;
}

class EncoderPeriodicErrorEffect final : public ReadingErrorEffect {
 public:
  EncoderPeriodicErrorEffect()
      : ReadingErrorEffect(
            {.name = "encoder_periodic_error",
             .family = Family::kEncoder,
             .kind = Kind::kEncoder,
             .site = SiteKind::kSensor,
             .variable = LawVariable::kPosition,
             .parameters = {Free("amplitude", Role::kAmplitude, "m"),
                            Positive("period", Role::kPeriod, "m"), Phase()},
             .meaning = "the reading plus amplitude sin(2 pi reading / period + phase)",
             .odds = kRare}) {}

  double Read(double y, double, const EffectValues& values) const noexcept override {
    return y + values[0] * std::sin(2.0 * std::numbers::pi / values[1] * y + values[2]);
  }
  std::optional<ParameterScan> MakeParameterScan(const SiteMotion& at,
                                                 double) const override {
    constexpr int kFinest = 1600;  // far more than a motor has poles
    const Eigen::VectorXd y = WithoutOwnNoise(at.y());
    if (Range(y) == 0.0) return std::nullopt;
    return PeriodScan({}, y, kFinest, 2);
  }
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({2e-3 * k.stroke, kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double period = k.stroke * r.Log(0.005, 0.3);
    const double phase = r.Uniform(-std::numbers::pi, std::numbers::pi);
    const double amplitude = 1e-3 * k.stroke;
    return [=](double s) { return ValuesOf({s * amplitude, period, phase}); };
  }
};

}  // namespace

const Effect& EncoderPeriodicError() {
  static const EncoderPeriodicErrorEffect effect;
  return effect;
}

}  // namespace mjdiag
