// The reading times factor.

#include "mjdiag/plugin/effects/encoder/reading_error.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class EncoderScaleEffect final : public ReadingErrorEffect {
 public:
  EncoderScaleEffect()
      : ReadingErrorEffect({.name = "encoder_scale",
                            .family = Family::kEncoder,
                            .kind = Kind::kEncoder,
                            .site = SiteKind::kSensor,
                            .variable = LawVariable::kPosition,
                            .parameters = {Free("factor", Role::kFactor, "1")},
                            .meaning = "the reading times factor",
                            .odds = kSome}) {}

  double Read(double y, double, const EffectValues& values) const noexcept override {
    return values[0] * y;
  }
  double ReadingScale(const EffectValues& values) const override { return values[0]; }
  // One that reads backwards is wired wrongly, which the check of the data says.
  double Least(const mjModel&, Eigen::Index, std::size_t) const override { return 0.0; }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(at.y(), {}, 1.0)};
  }
  // Rulers and gratings are right to a few parts in a thousand.
  EffectValues Spread(const Scales&) const override { return ValuesOf({0.003}); }
  Sized Draw(const Scales&, Random& r) const override {
    return AroundOne(r.Sign() * 0.01);
  }
};

}  // namespace

const Effect& EncoderScale() {
  static const EncoderScaleEffect effect;
  return effect;
}

}  // namespace mjdiag
