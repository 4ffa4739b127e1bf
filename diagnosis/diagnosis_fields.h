#pragma once
// What a diagnosis says (fields.h), schema "mjdiag.diagnosis/1". Residuals are in units of
// their own noise.

#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/signals/fields.h"

namespace mjdiag {

template <>
inline constexpr auto kFields<FaultVerdict> = std::tuple{
    Everywhere("name", "", "Of the fault parameter.", &FaultVerdict::name),
    Everywhere("value", "", "The fault parameter.", &FaultVerdict::value),
    Everywhere("deviation", "", "value less healthy.", &FaultVerdict::deviation),
    Everywhere("sd", "", "Standard deviation of value.", &FaultVerdict::sd),
    Everywhere("ci95", "",
               "Interval (low, high) that holds the true value in 95 of 100 records.",
               [](const FaultVerdict& fault) {
                 return std::pair{fault.ci95.min, fault.ci95.max};
               }),
    Everywhere("detected", "", "Whether it is named as a fault.",
               &FaultVerdict::detected),
    Everywhere("alarm", "", "Deviation from which on it would be named, alone.",
               &FaultVerdict::alarm),
    Everywhere("alarm_with_more_records", "",
               "The same with ever more healthy records of ever other motions.",
               &FaultVerdict::best_alarm)};

template <>
inline constexpr auto kFields<DisturbanceTone> = std::tuple{
    InJson("frequency", "Hz", "Of a tone.", &DisturbanceTone::frequency),
    InJson("frequency_sd", "Hz", "Its standard deviation by noise.",
           &DisturbanceTone::frequency_sd),
    InJson("psd", "1/Hz", "Of the residual there.", &DisturbanceTone::psd),
    InJson("threshold", "1/Hz", "What that left.", &DisturbanceTone::threshold),
    InJson("amplitude", "", "Of the sine in the residual.",
           &DisturbanceTone::amplitude),
    InJson("amplitude_sd", "", "Its standard deviation by noise.",
           &DisturbanceTone::amplitude_sd)};

template <>
inline constexpr auto kFields<DisturbanceReport> = std::tuple{
    InJson("peaks", "", "Tones in the residual, by frequency.",
           &DisturbanceReport::tones),
    InJson("total", "", "Power of the residual in the band.",
           &DisturbanceReport::total),
    InJson("total_threshold", "", "Its limit.", &DisturbanceReport::total_threshold),
    InJson("noise_ratio", "", "Density without the tones, times the nominal one.",
           &DisturbanceReport::noise_ratio),
    InJson("noise_raised", "", "Whether that is more than chance.",
           &DisturbanceReport::noise_raised)};

template <>
inline constexpr auto kFields<DiagnosisResult> = std::tuple{
    InJson("schema", "", R"("mjdiag.diagnosis/1".)",
           [](const DiagnosisResult&) { return "mjdiag.diagnosis/1"; }),
    Everywhere("setup", "", "Name of the setup.", &DiagnosisResult::setup),
    Everywhere("samples", "", "Of the record.", &DiagnosisResult::samples),
    Everywhere("sample_time", "s", "Between two samples.",
               &DiagnosisResult::sample_time),
    Everywhere("detected", "", "Whether anything is wrong.",
               &DiagnosisResult::detected),
    InPython("verdict", "", "The answer in one sentence.", &DiagnosisVerdict),
    Everywhere("first_detection", "s",
               "When the residual first left its limits, since the first sample; none.",
               &DiagnosisResult::first_detection),
    InJson("lasting_since", "s",
           "When its mean magnitude did, which no passing disturbance does; none.",
           &DiagnosisResult::lasting),
    InPython("lasting", "s",
             "When its mean magnitude did, which no passing disturbance does; None.",
             &DiagnosisResult::lasting),
    InJson("residual", "",
           "Its extremes and limits: min, max, threshold_min, threshold_max.",
           [](const DiagnosisResult& result) {
             return Named<double>{{"min", result.residual.min},
                                  {"max", result.residual.max},
                                  {"threshold_min", result.limits.min},
                                  {"threshold_max", result.limits.max}};
           }),
    InPython("limits", "", "Limits (low, high) of the residual.",
             [](const DiagnosisResult& result) {
               return std::pair{result.limits.min, result.limits.max};
             }),
    InJson("faults", "",
           "Every fault parameter of the plant and every disturbance of the setup.",
           &DiagnosisResult::faults),
    InPython(
        "faults", "",
        "Every fault parameter of the plant and every disturbance of the setup, by "
        "name.",
        [](const DiagnosisResult& result) {
          return NamedBy(result.faults, &FaultVerdict::name, std::identity());
        }),
    InJson("misfit", "",
           "Squared innovations of the twin over what is expected: 1 where it explains "
           "all that it sees; null without a twin.",
           [](const DiagnosisResult& result) {
             return result.by_twin ? std::optional(result.nis) : std::nullopt;
           }),
    InPython(
        "misfit", "",
        "Squared innovations of the twin over what is expected: 1 where it explains "
        "all that it sees.",
        &DiagnosisResult::nis),
    Everywhere("model_records", "",
               "Healthy records that tell how uncertain the model is; 0: none.",
               &DiagnosisResult::model_records),
    InJson("disturbance", "", "What acts on the machine from outside.",
           &DiagnosisResult::disturbance)};

}  // namespace mjdiag
