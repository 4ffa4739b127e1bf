#pragma once
// `mjdiag compare --json`: the figures of a comparison for other programs.

#include <nlohmann/json.hpp>

#include "mjdiag/discovery/comparison/comparison.h"

namespace mjdiag {

/// schema "mjdiag.compare/1"; channels {name: {rms, unit, relative_error_percent,
/// noise_floor, exceeds_noise, peak, p_value, worst_window {start, duration, rms}}};
/// derived {name: relative_error_percent}; exceeds_noise of any channel; level of the
/// test; samples, sample_time [s], skip_samples; not_measured [channels]. All in SI
/// units. Where the record has all sensors and commands also prediction {horizons [s], rms
/// {channel: [..]}}, missing_force {joint: rms [N, N m]} and deviance, -2 ln L of the filter.
/// falls: a free simulation runs away, channels are what is predicted over one tick. What has
/// no finite value is null.
nlohmann::json ToJson(const Comparison& comparison);

}  // namespace mjdiag
