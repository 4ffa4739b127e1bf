// Errors of what the sensors read. White noise is not among them: it goes into the
// noise of the channels (WithEncoderNoise).

#include <cmath>
#include <numbers>
#include <vector>

#include "mjdiag/plugin/effects/effect_factory.h"

namespace mjdiag {
namespace {

/// One error of all channels that read a sensor.
class EncoderEffect : public ActiveEffect {
 public:
  EncoderEffect(const Channels& channels, const EffectSpec& spec) {
    for (std::size_t i = 0; i < channels.sensors.size(); ++i) {
      if (channels.sensors[i].element == spec.site) channels_.push_back(i);
    }
  }
  void Distort(std::span<double> readings, double time) noexcept final {
    for (const std::size_t i : channels_) readings[i] = Read(readings[i], time);
  }

 private:
  virtual double Read(double true_reading, double time) const noexcept = 0;

  std::vector<std::size_t> channels_;
};

class EncoderScale final : public EncoderEffect {
 public:
  EncoderScale(const Channels& channels, const EffectSpec& spec)
      : EncoderEffect(channels, spec), factor_(spec.Value("factor")) {}

 private:
  double Read(double y, double) const noexcept override { return factor_ * y; }

  double factor_;
};

class EncoderPeriodicError final : public EncoderEffect {
 public:
  EncoderPeriodicError(const Channels& channels, const EffectSpec& spec)
      : EncoderEffect(channels, spec),
        amplitude_(spec.Value("amplitude")),
        wave_number_(2.0 * std::numbers::pi / spec.Value("period")),
        phase_(spec.Value("phase")) {}

 private:
  double Read(double y, double) const noexcept override {
    return y + amplitude_ * std::sin(wave_number_ * y + phase_);
  }

  double amplitude_;
  double wave_number_;
  double phase_;
};

class EncoderDrift final : public EncoderEffect {
 public:
  EncoderDrift(const Channels& channels, const EffectSpec& spec)
      : EncoderEffect(channels, spec), rate_(spec.Value("rate")) {}

 private:
  double Read(double y, double time) const noexcept override {
    return y + rate_ * time;
  }

  double rate_;
};

}  // namespace

std::unique_ptr<ActiveEffect> MakeEncoderEffect(const Channels& channels,
                                                const EffectSpec& spec) {
  if (spec.effect == "encoder_scale") {
    return std::make_unique<EncoderScale>(channels, spec);
  }
  if (spec.effect == "encoder_periodic_error") {
    return std::make_unique<EncoderPeriodicError>(channels, spec);
  }
  if (spec.effect == "encoder_drift") {
    return std::make_unique<EncoderDrift>(channels, spec);
  }
  return nullptr;
}

}  // namespace mjdiag
