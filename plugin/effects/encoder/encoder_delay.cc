// The reading of a moment ago, y - delay y'.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "mjdiag/plugin/effects/encoder/reading_error.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/reading_rate.h"

namespace mjdiag {
namespace {

constexpr double kLatest = 0.1;  // [s]

class LateReading final : public ActiveEffect {
 public:
  LateReading(const Channels& channels, const std::vector<std::size_t>& read,
              int sensor, double delay)
      : sensor_(sensor), delay_(delay) {
    for (const std::size_t i : read)
      late_.emplace_back(i, channels.sensors[i].component);
  }
  void Distort(const mjModel& model, const mjData& data, std::span<double> readings,
               double) noexcept override {
    for (const auto& [i, component] : late_) {
      readings[i] -= delay_ * ReadingRate(model, data, sensor_, component);
    }
  }

 private:
  int sensor_;
  double delay_;
  std::vector<std::pair<std::size_t, int>> late_;  // channels and components
};

// To first order: it has no memory, so that a filter knows where the machine is by its state
// alone. What that leaves is a half of delay^2 times the acceleration.
class EncoderDelayEffect final : public Effect {
 public:
  EncoderDelayEffect()
      : Effect({.name = "encoder_delay",
                .family = Family::kEncoder,
                .kind = Kind::kEncoder,
                .site = SiteKind::kSensor,
                .variable = LawVariable::kVelocity,
                .parameters = {{"delay", Role::kTime, "s", 0.0, kLatest}},
                .meaning = "the reading of a moment ago"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels& channels,
                                         int element,
                                         const EffectValues& values) const override {
    return std::make_unique<LateReading>(channels, ChannelsOf(model, channels, element),
                                         element, values[0]);
  }
  // A machine whose only encoder is late is one whose drives are late: of two encoders that
  // see a joint, the second one may be late against the first.
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    const std::vector<Site> all = map.Sensors();
    std::vector<Site> second;
    for (auto site = all.begin(); site != all.end(); ++site) {
      const int sensor = FindElement(map.plant(), mjOBJ_SENSOR, site->name);
      const bool is_second = std::any_of(
          all.begin(), site, [&](const Site& one) { return one.joint == site->joint; });
      if (is_second && HasRate(map.plant(), sensor)) second.push_back(*site);
    }
    return second;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd rate =
        CentralDifferences(at.y().transpose(), at.motion.sample_time).transpose();
    return {LinearRegressor(-rate, {}, 0.0, true)};
  }
  Sized Draw(const Scales&, Random&) const override { return Proportional(2e-4); }
};

}  // namespace

const Effect& EncoderDelay() {
  static const EncoderDelayEffect effect;
  return effect;
}

}  // namespace mjdiag
