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
                            .kind = Kind::kEncoder,
                            .site = SiteKind::kSensor,
                            .variable = LawVariable::kTime,
                            .parameters = {Free("rate", Role::kAmplitude, "m/s")},
                            .meaning = "the reading plus rate t",
                            .odds = kRare}) {}

  double Read(double y, double time,
              const EffectValues& values) const noexcept override {
    return y + values[0] * time;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(at.motion.time, {})};
  }
  // What heat moves in the time of a record.
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({2e-3 * k.stroke / k.duration});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    return Proportional(r.Sign() * 4e-3 * k.stroke / k.duration);
  }
};

}  // namespace

const Effect& EncoderDrift() {
  static const EncoderDriftEffect effect;
  return effect;
}

}  // namespace mjdiag
