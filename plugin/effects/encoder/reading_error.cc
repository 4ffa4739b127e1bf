#include "mjdiag/plugin/effects/encoder/reading_error.h"

#include <utility>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

class ReadingError final : public ActiveEffect {
 public:
  ReadingError(const ReadingErrorEffect& effect, std::vector<std::size_t> channels,
               EffectValues values)
      : effect_(effect), channels_(std::move(channels)), values_(std::move(values)) {}
  void Distort(const mjModel&, const mjData&, std::span<double> readings,
               double time) noexcept override {
    for (const std::size_t i : channels_) {
      readings[i] = effect_.Read(readings[i], time, values_);
    }
  }

 private:
  const ReadingErrorEffect& effect_;
  std::vector<std::size_t> channels_;
  EffectValues values_;
};

}  // namespace

std::vector<std::size_t> ChannelsOf(const mjModel& model, const Channels& channels,
                                    int element) {
  const std::string sensor = ElementName(model, mjOBJ_SENSOR, element);
  std::vector<std::size_t> read;
  for (std::size_t i = 0; i < channels.sensors.size(); ++i) {
    if (channels.sensors[i].element == sensor) read.push_back(i);
  }
  return read;
}

std::unique_ptr<ActiveEffect> ReadingErrorEffect::Activate(
    const mjModel& model, const Channels& channels, int element,
    const EffectValues& values) const {
  return std::make_unique<ReadingError>(*this, ChannelsOf(model, channels, element),
                                        values);
}

}  // namespace mjdiag
