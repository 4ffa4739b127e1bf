// White noise of that standard deviation, beside the sensor's own. It shows in the
// variance of the innovations, not in their course: it has no trials and is no
// candidate.

#include <cmath>

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class EncoderNoiseEffect final : public Effect {
 public:
  EncoderNoiseEffect()
      : Effect({.name = "encoder_noise",
                .family = Family::kEncoder,
                .kind = Kind::kEncoder,
                .site = SiteKind::kSensor,
                .form = Form::kNoise,
                .variable = LawVariable::kTime,
                .parameters = {NotNegative("sd", Role::kAmplitude, "m")},
                .meaning = "white noise of that standard deviation, beside the "
                           "sensor's own"}) {}

  double NoiseSd(double sd, const EffectValues& values) const override {
    return std::hypot(sd, values[0]);
  }
  std::vector<Site> CandidateSites(const SiteMap&) const override { return {}; }
  Sized Draw(const Scales& k, Random& r) const override {
    return Proportional(k.noise * r.Log(0.5, 10.0));
  }
};

}  // namespace

const Effect& EncoderNoise() {
  static const EncoderNoiseEffect effect;
  return effect;
}

}  // namespace mjdiag
