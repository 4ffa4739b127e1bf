#include "mjdiag/discovery/answer/prediction_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/discovery/answer/model_on_runs.h"
#include "mjdiag/discovery/mismatch_figures.h"

namespace mjdiag {

using Eigen::Index;

namespace {

std::map<std::string, double> ErrorsOver(const Prediction& prediction, Index horizon) {
  std::map<std::string, double> errors;
  for (const Prediction::Sensor& sensor : prediction.sensors) {
    errors[sensor.channel] = sensor.rms[horizon];
  }
  return errors;
}

bool IsFinite(const Prediction& prediction, Index horizon) {
  return std::ranges::all_of(prediction.sensors, [&](const Prediction::Sensor& sensor) {
    return std::isfinite(sensor.rms[horizon]);
  });
}

}  // namespace

void AddPredictions(const AnswerData& data, const UnseenJudgement& judged,
                    Discovery& discovery) {
  // Before and after in what was fitted, and in what was not.
  const std::array all{PredictionOf(data, judged.nothing, true),
                       PredictionOf(data, judged.answer, true),
                       PredictionOf(data, judged.nothing, false),
                       PredictionOf(data, judged.answer, false)};
  Index longest = std::ssize(all.front().horizons);
  for (const Prediction& one : all) {
    longest = std::min<Index>(longest, std::ssize(one.horizons));
  }
  Index horizon = 0;
  for (Index h = 0; h < longest; ++h) {
    if (!IsWithinHorizon(all.front().horizons[static_cast<std::size_t>(h)])) break;
    if (std::ranges::all_of(all, [&](const auto& one) { return IsFinite(one, h); })) {
      horizon = h;
    }
  }
  discovery.horizon = all.front().horizons[static_cast<std::size_t>(horizon)];
  discovery.mismatch_before = {ErrorsOver(all[0], horizon),
                               ErrorsOver(all[2], horizon)};
  discovery.mismatch_after = {ErrorsOver(all[1], horizon), ErrorsOver(all[3], horizon)};
  discovery.noise_floor.clear();
  for (std::size_t i = 0; i < all.front().sensors.size(); ++i) {
    const Prediction::Sensor& sensor = all.front().sensors[i];
    discovery.noise_floor[sensor.channel] =
        judged.answer.seen.noise.reading[static_cast<Index>(i)];
    discovery.unit[sensor.channel] = sensor.unit;
  }
  SetGains(discovery);
}

}  // namespace mjdiag
