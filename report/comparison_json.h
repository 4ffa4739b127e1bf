#pragma once
// `mjdiag compare --json`: the figures of a comparison for other programs.

#include <nlohmann/json.hpp>

#include "mjdiag/comparison/comparison.h"

namespace mjdiag {

/// schema "mjdiag.compare/1"; channels {name: {rms, unit, relative_error_percent,
/// noise_floor, exceeds_noise, peak, p_value, worst_window {start, duration, rms}}};
/// derived {name: relative_error_percent}; exceeds_noise of any channel; level of the
/// test; samples, sample_time [s], skip_samples; not_measured [channels]. All in SI
/// units. Of a machine that falls also prediction {horizons [s], rms {channel: [..]}} and
/// missing_force {joint: rms [N, N m]}, beside the observer of that bandwidth [Hz]; channels
/// are then what is predicted over one tick. A relative error without a finite value is null.
nlohmann::json ToJson(const Comparison& comparison);

}  // namespace mjdiag
