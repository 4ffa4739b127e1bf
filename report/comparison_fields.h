#pragma once
// What a comparison says (fields.h), schema "mjdiag.compare/1". All in SI units.

#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/report/comparison_page.h"
#include "mjdiag/signals/fields.h"

namespace mjdiag {

template <>
inline constexpr auto kFields<WorstWindow> = std::tuple{
    InJson("start", "s", "On the time axis of the record.", &WorstWindow::start),
    InJson("duration", "s", "How long it is.", &WorstWindow::duration),
    InJson("rms", "unit", "Within it.", &WorstWindow::rms)};

template <>
inline constexpr auto kFields<ChannelMismatch> = std::tuple{
    InPython("name", "", "Of the channel.", &ChannelMismatch::name),
    Everywhere("unit", "", "SI.", &ChannelMismatch::unit),
    Everywhere("rms", "unit", "Root of the mean square.", &ChannelMismatch::rms),
    Everywhere("mae", "unit", "Mean magnitude.", &ChannelMismatch::mae),
    Everywhere("peak", "unit", "Largest magnitude.", &ChannelMismatch::peak),
    Everywhere(
        "fit_percent", "%",
        "100: nothing is wrong; 0: the mean of what was measured would do as well; "
        "negative, down to -inf, beyond.",
        &ChannelMismatch::fit_percent),
    Everywhere("relative_error_percent", "%",
               "100 ||measured - simulated|| / ||measured||; may be inf.",
               &ChannelMismatch::relative_error_percent),
    Everywhere("noise_floor", "unit", "The rms if noise were all there is.",
               [](const ChannelMismatch& channel) { return channel.noise_floor.rms; }),
    Everywhere("exceeds_noise", "", "Whether there is more than noise.",
               &ChannelMismatch::exceeds_noise),
    Everywhere("p_value", "", "Chance that noise alone reaches this rms.",
               &ChannelMismatch::p_value),
    InJson("worst_window", "", "Where it is largest.", &ChannelMismatch::worst),
    InPython("worst_window", "",
             "Where it is largest: (start [s], duration [s], rms [unit]).",
             [](const ChannelMismatch& channel) {
               const WorstWindow& worst = channel.worst;
               return std::tuple{worst.start, worst.duration, worst.rms};
             })};

inline Named<Eigen::VectorXd> PredictionErrors(const Prediction& prediction) {
  using Sensor = Prediction::Sensor;
  return NamedBy(prediction.sensors, &Sensor::channel, &Sensor::rms);
}

template <>
inline constexpr auto kFields<Prediction> = std::tuple{
    InJson("horizons", "s", "How far ahead.", &Prediction::horizons),
    InJson("rms", "unit", "Of the error over every horizon, by sensor channel.",
           &PredictionErrors)};

template <>
inline constexpr auto kFields<DisturbanceEstimate> = std::tuple{
    InPython("joint", "", "Its name.", &DisturbanceEstimate::joint),
    InPython("unit", "", R"("N" or "N m".)", &DisturbanceEstimate::unit),
    InPython("rms", "unit", "Of value.", &DisturbanceEstimate::rms),
    InPython("sd", "unit", "Standard deviation of its error.",
             &DisturbanceEstimate::sd),
    InPython("memory", "s", "How long it lasts.", &DisturbanceEstimate::memory)};

/// What the filter says that follows the motion, where the record has all that it needs.
template <typename Get>
constexpr auto IfFollowed(Get get) {
  return [get](const Comparison& comparison) {
    using Value = std::decay_t<std::invoke_result_t<Get, const Comparison&>>;
    return comparison.deviance ? IfAny<Value>(std::invoke(get, comparison))
                               : IfAny<Value>();
  };
}

template <>
inline constexpr auto kFields<Comparison> = std::tuple{
    InJson("schema", "", R"("mjdiag.compare/1".)",
           [](const Comparison&) { return "mjdiag.compare/1"; }),
    Everywhere("setup", "", "Name of the setup.", &Comparison::setup),
    InPython("verdict", "", "The answer in one sentence.", &ComparisonVerdict),
    Everywhere(
        "closed_loop", "",
        "Whether the measured reference was followed; else the inputs were applied.",
        &Comparison::closed_loop),
    Everywhere(
        "samples", "", "Of the record.",
        [](const Comparison& comparison) { return comparison.measured.samples(); }),
    Everywhere(
        "sample_time", "s", "Between two samples.",
        [](const Comparison& comparison) { return comparison.measured.sample_time(); }),
    Everywhere("skip_samples", "", "Left out of all figures at the start.",
               [](const Comparison& comparison) -> std::int64_t {
                 return comparison.options.skip_samples;
               }),
    Everywhere("level", "", "Chance to call plain noise a mismatch, per channel.",
               [](const Comparison& comparison) { return comparison.options.level; }),
    Everywhere("exceeds_noise", "", "Whether any channel has more than noise.",
               &Comparison::exceeds_noise),
    Everywhere(
        "falls", "",
        "Whether the machine does not stay with the measurement when its inputs "
        "alone drive it. Channels are then what a filter that follows the motion "
        "predicts from one tick to the next, and derived is empty.",
        &Comparison::falls),
    Everywhere(
        "channels", "",
        "Measured less simulated, of sensors and, in closed loop, actuators, by name.",
        [](const Comparison& comparison) {
          return NamedBy(comparison.channels, &ChannelMismatch::name, std::identity());
        }),
    Everywhere(
        "derived", "%",
        "Relative error of velocities, accelerations and forces, by name; may be inf.",
        [](const Comparison& comparison) {
          return NamedBy(comparison.derived, &DerivedMismatch::name,
                         &DerivedMismatch::relative_error_percent);
        }),
    InPython("measured", "", "Record of the channels as they were measured.",
             &Comparison::measured),
    InPython("simulated", "",
             "Record of the same channels as they were simulated, without noise.",
             &Comparison::simulated),
    Everywhere("not_measured", "", "Channels that the record lacks.",
               &Comparison::not_measured),
    InJson("prediction", "",
           "How far ahead the plant predicts from states that a filter has found. Not "
           "there, "
           "like the next two, where the record lacks sensors or commands.",
           IfFollowed(&Comparison::prediction)),
    InPython("horizons", "s", "How far ahead it predicts, (horizons,).",
             [](const Comparison& comparison) -> Eigen::VectorXd {
               const std::vector<double>& all = comparison.prediction.horizons;
               return Eigen::VectorXd::Map(all.data(), std::ssize(all));
             }),
    InPython(
        "prediction", "unit",
        "Sensor channel -> rms of the error over every horizon, (horizons,); inf where "
        "a prediction diverges.",
        [](const Comparison& comparison) {
          return PredictionErrors(comparison.prediction);
        }),
    InJson("missing_force", "N or N m",
           "Rms of the force that the plant lacks, by joint.",
           IfFollowed([](const Comparison& comparison) {
             return NamedBy(comparison.missing_force, &DisturbanceEstimate::joint,
                            &DisturbanceEstimate::rms);
           })),
    InPython("missing_force", "", "The force that the plant lacks, by joint.",
             [](const Comparison& comparison) {
               return NamedBy(comparison.missing_force, &DisturbanceEstimate::joint,
                              std::identity());
             }),
    Everywhere(
        "deviance", "",
        "-2 ln L of the filter that follows the motion: of two models of one record "
        "the one with the lower is more probable. None where the record lacks sensors "
        "or commands; prediction and missing_force are then empty.",
        IfFollowed([](const Comparison& comparison) { return *comparison.deviance; }))};

}  // namespace mjdiag
