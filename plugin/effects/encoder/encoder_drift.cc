// The reading plus rate t.

#include "mjdiag/plugin/effects/encoder/reading_error.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class EncoderDriftEffect final : public ReadingErrorEffect {
 public:
  EncoderDriftEffect()
      : ReadingErrorEffect({.name = "encoder_drift",
                            .family = Family::kEncoder,
                            .site = SiteKind::kSensor,
                            .variable = LawVariable::kTime,
                            .parameters = {Free("rate", Role::kAmplitude, "m/s")},
                            .meaning = "the reading plus rate t"}) {}

  double Read(double y, double time,
              const EffectValues& values) const noexcept override {
    return y + values[0] * time;
  }
  std::vector<Trial> Trials(const SiteMotion& at) const override {
    const Eigen::Index n = at.motion.samples();
    const double last = static_cast<double>(n - 1) * at.motion.sample_time;
    return {LinearTrial(Eigen::VectorXd::LinSpaced(n, 0.0, last), {})};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    return Proportional(r.Sign() * 0.02 * k.stroke / k.duration);
  }
};

}  // namespace

const Effect& EncoderDrift() {
  static const EncoderDriftEffect effect;
  return effect;
}

}  // namespace mjdiag
