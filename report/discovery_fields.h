#pragma once
// What a discovery says (fields.h), schema "mjdiag.discovery/1". A fault parameter off its
// healthy value is a cause whose effect is its name and whose only parameter is "value". All
// in SI units; a figure that was not computed, such as that of a validation record that was
// not given, is null.

#include <cmath>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/discovery/explanations.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/report/cause_text.h"
#include "mjdiag/report/discovery_text.h"
#include "mjdiag/report/kinds_text.h"
#include "mjdiag/signals/fields.h"

namespace mjdiag {

inline constexpr const char* kInterval =
    "Interval (low, high) that holds the true value in 95 of 100 records.";

template <typename T>
std::pair<double, double> IntervalOf(const T& number) {
  return {number.low, number.high};
}

/// What every cause has, of something with one in it.
template <typename Get>
constexpr auto IdentityFields(Get cause) {
  return std::tuple{
      Everywhere("effect", "",
                 "Name of the effect (docs/effects.md) or of the fault parameter.",
                 [cause](const auto& one) { return std::invoke(cause, one).name(); }),
      Everywhere("site", "", "The joint, actuator or sensor at which it acts.",
                 [cause](const auto& one) { return std::invoke(cause, one).site; }),
      Everywhere("fault", "", "Whether it is a fault parameter of the plant.",
                 [cause](const auto& one) {
                   return std::invoke(cause, one).effect->IsFault();
                 })};
}

template <>
inline constexpr auto kFields<Cause> = IdentityFields(std::identity());

template <>
inline constexpr auto kFields<CauseParameter> = std::tuple{
    InPython("name", "", "Of the parameter.", &CauseParameter::name),
    Everywhere("value", "unit", "As found.", &CauseParameter::value),
    Everywhere("unit", "", "SI.", &CauseParameter::unit),
    Everywhere("sd", "unit", "Standard deviation of value.", &CauseParameter::sd),
    Everywhere("ci95", "unit", kInterval, &IntervalOf<CauseParameter>)};

template <>
inline constexpr auto kFields<Alternative> = std::tuple_cat(
    IdentityFields(&Alternative::cause),
    std::tuple{InJson("probability", "", "Of it, in the place of the cause.",
                      &Alternative::probability),
               InJson("indistinguishable", "", "No measurement tells them apart.",
                      &Alternative::indistinguishable)});

template <>
inline constexpr auto kFields<FoundCause::NumberInstead> =
    std::tuple{InJson("name", "", "Of the number.", &FoundCause::NumberInstead::name),
               InJson("probability", "", "Of it, in the place of the cause.",
                      &FoundCause::NumberInstead::probability)};

template <>
inline constexpr auto kFields<FoundCause> = std::tuple_cat(
    IdentityFields(&FoundCause::cause),
    std::tuple{
        Everywhere("parameters", "", "By name.",
                   [](const FoundCause& found) {
                     return NamedBy(found.parameters, &CauseParameter::name,
                                    std::identity());
                   }),
        Everywhere("probability", "", "Among all that could be in its place.",
                   &FoundCause::probability),
        InJson("alternatives", "",
               "What else could be in its place, 1 % or more, likeliest first.",
               &FoundCause::alternatives),
        InPython(
            "alternatives", "",
            "Pairs (name, probability) of what else could be, 1 % or more, likeliest "
            "first.",
            [](const FoundCause& found) {
              std::vector<std::pair<std::string, double>> pairs;
              for (const Alternative& other : found.alternatives) {
                pairs.emplace_back(CauseName(other.cause), other.probability);
              }
              return pairs;
            }),
        InJson("numbers_instead", "", "Numbers of the plant that could be.",
               &FoundCause::numbers),
        Everywhere("nothing_instead", "", "Probability that nothing is in its place.",
                   &FoundCause::none),
        InJson("unnamed", "",
               "Of a force that was learned and has no name, what it is.",
               [](const FoundCause& found) { return TextOrNone(found.unnamed); }),
        InPython("words", "",
                 R"(Of a force that was learned and has no name, what it is; else "".)",
                 &FoundCause::unnamed)});

template <>
inline constexpr auto kFields<CauseSet> = std::tuple{
    InJson("probability", "", "Of these and no others.", &CauseSet::probability),
    InJson("causes", "", "All of them.", &CauseSet::causes)};

template <>
inline constexpr auto kFields<FoundKind> = std::tuple{
    InJson("kind", "", R"("dry friction", "compliance", "drive gain", ...)",
           [](const FoundKind& found) { return KindName(found.kind); }),
    InPython("name", "", R"("dry friction", "compliance", "drive gain", ...)",
             [](const FoundKind& found) { return KindName(found.kind); }),
    Everywhere("site", "", "The joint, actuator or sensor at which it acts.",
               &FoundKind::site),
    Everywhere("probability", "", "By what data that no fit saw lose without it.",
               &FoundKind::probability),
    Everywhere(
        "share", "",
        "Of the unseen mismatch that the answer takes away, what is back without it; "
        "0 of a number of the plant.",
        &FoundKind::share),
    Everywhere("words", "", "What and where it is, and how sure that is.", &KindWords)};

/// Of a number that is moved, not multiplied, by how far.
inline double FactorOrMove(const CalibratedNumber& number, double factor) {
  return number.shift > 0.0 ? number.shift * std::log(factor) : factor;
}

template <>
inline constexpr auto kFields<CalibratedNumber> = std::tuple{
    InJson("name", "", R"("mass@stage".)", &CalibratedNumber::name),
    InJson("value", "unit", "Times what the model says, or how far it is moved.",
           [](const CalibratedNumber& number) {
             return FactorOrMove(number, number.factor);
           }),
    InJson("ci95", "unit", kInterval,
           [](const CalibratedNumber& number) {
             return std::pair{FactorOrMove(number, number.low),
                              FactorOrMove(number, number.high)};
           }),
    InJson("prior_sd", "unit",
           "Standard deviation as far as was known before the record.",
           [](const CalibratedNumber& number) {
             return number.shift > 0.0 ? number.shift * number.doubt : number.doubt;
           }),
    InJson("unit", "", R"("1" of a factor.)",
           [](const CalibratedNumber& number) {
             return number.shift > 0.0 ? number.shift_unit : "1";
           }),
    InJson("off", "", "Whether it is another than the model's.", &IsOff)};

template <>
inline constexpr auto kFields<CalibratedMoment> = std::tuple{
    InJson("joint", "", "What carries the masses.", &CalibratedMoment::joint),
    InJson("axis", "", "Of the frame of the body that it turns.",
           &CalibratedMoment::axis),
    InJson("unit", "", R"("kg m".)", [](const CalibratedMoment&) { return "kg m"; }),
    InJson("model", "unit", "As the model has it.", &CalibratedMoment::model),
    InJson("value", "unit", "As the record has it.", &CalibratedMoment::value),
    InJson("ci95", "unit", kInterval, &IntervalOf<CalibratedMoment>),
    InJson("prior_sd", "unit",
           "Standard deviation as far as was known before the record.",
           &CalibratedMoment::doubt),
    InJson("off", "", "Whether it is another than the model's.", &IsMoved)};

template <>
inline constexpr auto kFields<FoundResistance::Span> =
    std::tuple{InJson("value", "", "Along the motion, by least squares.",
                      &FoundResistance::Span::value),
               InJson("ci95", "", kInterval, &IntervalOf<FoundResistance::Span>)};

template <>
inline constexpr auto kFields<FoundResistance> = std::tuple{
    InJson("joint", "", "What is resisted.", &FoundResistance::site),
    InJson("members", "", "Members of the answer that do.", &FoundResistance::members),
    InJson("force_unit", "", R"("N" or "N m".)", &FoundResistance::ForceUnit),
    InJson("speed_unit", "", R"("m/s" or "rad/s".)", &FoundResistance::SpeedUnit),
    InJson("dry", "force_unit",
           "What does not depend on the speed, of all of them together.",
           &FoundResistance::dry),
    InJson("viscous", "force_unit over speed_unit", "What is proportional to it.",
           &FoundResistance::viscous),
    InJson("speeds", "speed_unit", "Along the motion, of as many samples each.",
           &FoundResistance::speeds),
    InJson("force", "force_unit", "Resistance there, mean of both directions.",
           &FoundResistance::force),
    InJson("half_ci95", "force_unit", "Half of its 95 % interval.",
           &FoundResistance::half)};

template <>
inline constexpr auto kFields<Discovery::Figures> = std::tuple{
    InJson("train", "of the channel", "On what fits saw, by channel.",
           &Discovery::Figures::train),
    InJson(
        "validation", "of the channel",
        "On what they did not see: the validation records, or the rest of the record.",
        &Discovery::Figures::validation)};

inline Named<Named<double>> ReplayFigures(const Comparison& comparison) {
  return NamedBy(comparison.channels, &ChannelMismatch::name,
                 [](const ChannelMismatch& channel) {
                   return Named<double>{{"rms", channel.rms},
                                        {"mae", channel.mae},
                                        {"fit_percent", channel.fit_percent}};
                 });
}

template <>
inline constexpr auto kFields<RecordReplay> = std::tuple{
    InJson("file", "", "Name of the record.", &RecordReplay::name),
    InJson(
        "role", "", R"("fit" or "validation".)",
        [](const RecordReplay& replay) { return replay.seen ? "fit" : "validation"; }),
    InJson("before", "", "With the plant as given, by channel: rms, mae, fit_percent.",
           [](const RecordReplay& replay) { return ReplayFigures(replay.before); }),
    InJson("replay", "", "The same with the extended plant.",
           [](const RecordReplay& replay) { return ReplayFigures(replay.after); })};

template <>
inline constexpr auto kFields<LadderStep> = std::tuple{
    InJson("added", "", R"("nothing", "coulomb_friction@load", ...)",
           &LadderStep::added),
    InJson("train", "", "Innovations over sensor noise, rms; 1: noise is all there is.",
           &LadderStep::train),
    InJson("held_out", "", "The same on parts that no fit saw.", &LadderStep::held_out),
    InJson("error_percent", "%", "Relative error of a replay, by signal.",
           &LadderStep::error_percent),
    InJson("validation_percent", "%", "The same of the validation record.",
           &LadderStep::validation_percent)};

template <>
inline constexpr auto kFields<FaultLimit> = std::tuple{
    InJson("fault", "", "The fault parameter.", &FaultLimit::fault),
    InJson("before", "", "Smallest change that is seen with the plant as given.",
           &FaultLimit::before),
    InJson("after", "", "The same with the extended plant.", &FaultLimit::after)};

template <>
inline constexpr auto kFields<Budget> = std::tuple{
    InJson("used", "s", "What it took.", &Budget::used),
    InJson("limit", "s", "What it had; null: all that it wants.", &Budget::limit),
    InJson("stopped", "", "Whether it was asked to end.", &Budget::stopped),
    InJson("left_out", "", "What it did not come to.", &Budget::left_out)};

template <>
inline constexpr auto kFields<Decision> = std::tuple{
    InJson("tried", "", "A model, or what was done to one.", &Decision::tried),
    InJson("score", "", "-2 ln of how much more probable the model before was.",
           &Decision::score),
    InJson("why", "", "What came of it.", &Decision::why)};

/// What is left when all causes are in the model, and what it depends on.
struct Remainder {
  const Discovery* discovery;
};
/// Of what it depends on, no field where nothing is left.
template <typename T>
constexpr auto IfLeft(T ResidualDependence::*figure) {
  return [figure](const Remainder& rest) {
    const std::optional<ResidualDependence>& left = rest.discovery->unexplained;
    if constexpr (std::is_same_v<T, std::string>) {
      using Text = IfAny<std::optional<std::string>>;
      return left ? Text(TextOrNone(*left.*figure)) : Text();
    } else {
      return left ? IfAny<T>(*left.*figure) : IfAny<T>();
    }
  };
}

template <>
inline constexpr auto kFields<Remainder> =
    std::tuple{InJson("signature", "", "One sentence; null where nothing is left.",
                      [](const Remainder& rest) {
                        const auto& left = rest.discovery->unexplained;
                        return left ? TextOrNone(left->text) : std::nullopt;
                      }),
               InJson("site", "", "The joint at which it acts.",
                      [](const Remainder& rest) {
                        using Text = IfAny<std::optional<std::string>>;
                        return rest.discovery->unexplained
                                   ? Text(TextOrNone(rest.discovery->unexplained_site))
                                   : Text();
                      }),
               InJson("variable", "", "What it depends on.",
                      IfLeft(&ResidualDependence::variable)),
               InJson("unit", "", "Of that.", IfLeft(&ResidualDependence::unit)),
               InJson("factor", "", "What that is multiplied by.",
                      IfLeft(&ResidualDependence::factor)),
               InJson("shape", "", R"("linear", "fourth power", ...)",
                      IfLeft(&ResidualDependence::shape)),
               InJson("explained_share", "", "What that explains of unseen parts.",
                      IfLeft(&ResidualDependence::explained_share)),
               InJson("period", "unit", "Of a periodic shape, else 0.",
                      IfLeft(&ResidualDependence::period)),
               InJson("exponent", "", "Of a power, else 0.",
                      IfLeft(&ResidualDependence::exponent)),
               InJson("runner_up", "", "The next best variable.",
                      IfLeft(&ResidualDependence::runner_up)),
               InJson("runner_up_share", "", "What that explains alone.",
                      IfLeft(&ResidualDependence::runner_up_share))};

inline Eigen::Index FittedSamples(const Discovery& discovery) {
  const RecordReplay* first = discovery.Fitted();
  return first != nullptr ? first->before.measured.samples() : 0;
}

/// Of the first record that fits saw, and the first that they did not.
inline Named<Named<std::optional<Named<double>>>> DerivedErrors(
    const Discovery& discovery) {
  const auto of = [&](Comparison RecordReplay::*model) {
    const auto on = [&](const RecordReplay* replay) {
      using Errors = std::optional<Named<double>>;
      if (replay == nullptr) return Errors();
      return Errors(NamedBy((replay->*model).derived, &DerivedMismatch::name,
                            &DerivedMismatch::relative_error_percent));
    };
    return Named<std::optional<Named<double>>>{{"record", on(discovery.Fitted())},
                                               {"validation", on(discovery.Unseen())}};
  };
  return {{"before", of(&RecordReplay::before)}, {"after", of(&RecordReplay::after)}};
}

template <>
inline constexpr auto kFields<Discovery> = std::tuple{
    InJson("schema", "", R"("mjdiag.discovery/1".)",
           [](const Discovery&) { return "mjdiag.discovery/1"; }),
    Everywhere("setup", "", "Name of the setup.", &Discovery::setup),
    Everywhere("verdict", "",
               R"("no_discrepancy", "explained", "partly_explained" or "unexplained".)",
               [](const Discovery& found) { return VerdictName(found.verdict); }),
    InPython("answer", "", "The answer in a sentence or two.", &DiscoveryAnswer),
    Everywhere("force_left", "",
               "Share of the missing force that is left on data which no fit saw; none "
               "where noise is all there is.",
               &Discovery::force_left),
    Everywhere("kinds", "",
               "The kinds of physics that are wrong, the most probable first; of those "
               "that are all but certain the one that matters most.",
               &Discovery::kinds),
    Everywhere("causes", "", "What the plant lacks, and faults.", &Discovery::causes),
    InJson("explanations", "",
           "All sets of causes that the record leaves possible, likeliest first.",
           [](const Discovery& found) { return ExplanationsOf(found.causes); }),
    InJson("calibration", "", "Numbers of the plant that were in doubt.",
           &Discovery::calibration),
    InJson("moments", "",
           "First moments of mass about hinges, of which a record tells no more.",
           &Discovery::moments),
    InJson("resistances", "",
           "Of every joint that more than one law of one size resists, all of them as "
           "one curve.",
           &Discovery::resistances),
    InJson("mismatch", "", "Rms of measured less simulated, before and after.",
           [](const Discovery& found) {
             return Named<Discovery::Figures>{{"before", found.mismatch_before},
                                              {"after", found.mismatch_after}};
           }),
    InPython("mismatch_before", "",
             "Two dicts, channel -> rms of measured less simulated in its unit: on "
             "what fits "
             "saw, and on what they did not see.",
             [](const Discovery& found) {
               const Discovery::Figures& figures = found.mismatch_before;
               return std::pair{figures.train, figures.validation};
             }),
    InPython("mismatch_after", "", "The same with the causes in the model.",
             [](const Discovery& found) {
               const Discovery::Figures& figures = found.mismatch_after;
               return std::pair{figures.train, figures.validation};
             }),
    Everywhere("horizon", "s",
               "Over how long a mismatch is predicted where no free simulation says "
               "anything; 0: of free simulation.",
               &Discovery::horizon),
    Everywhere("noise_floor", "of the channel", "The rms if noise were all there is.",
               &Discovery::noise_floor),
    Everywhere("units", "", "Of mismatch and noise floor, by channel.",
               &Discovery::unit),
    InJson("gain", "", "1 - after / before, by train and validation.",
           [](const Discovery& found) {
             return Named<double>{{"train", found.gain_train},
                                  {"validation", found.gain_validation}};
           }),
    InPython("gain", "",
             "1 - after / before, on what fits saw and on what they did not see.",
             [](const Discovery& found) {
               return std::pair{found.gain_train, found.gain_validation};
             }),
    Everywhere("whiteness", "",
               "Share of the innovations' power that is white, before and after.",
               [](const Discovery& found) {
                 return Named<double>{{"before", 1.0 - found.colour_before},
                                      {"after", 1.0 - found.colour_after}};
               }),
    // Where it is written, the command knows: ToJson.
    InJson("extended_plant", "", "Path of its MJCF file; null: none was written.",
           [](const Discovery&) { return std::optional<std::string>(); }),
    InJson("unexplained", "", "What is left; where nothing is, signature alone.",
           [](const Discovery& found) { return Remainder{&found}; }),
    Everywhere("train_share", "", "Of the record, what fits saw.",
               &Discovery::train_share),
    Everywhere("sample_time", "s", "Between two samples.", &Discovery::sample_time),
    Everywhere("substeps", "", "Steps of the physics in a control tick.",
               &Discovery::substeps),
    Everywhere("samples", "", "Of the first record that fits saw.", &FittedSamples),
    InJson(
        "derived", "%",
        "Relative error of velocities, accelerations and forces, by before and after, "
        "record and validation, and name.",
        &DerivedErrors),
    InJson("records", "", "How far the simulation of each is off.",
           &Discovery::records),
    InJson("ladder", "", "After each cause.", &Discovery::ladder),
    InJson("fault_limits", "", "How small a fault is seen.", &Discovery::fault_limits),
    InJson("budget", "", "Of time.", &Discovery::budget),
    InPython("stopped", "",
             "Whether Ctrl-C ended it; the answer is the best that it had.",
             [](const Discovery& found) { return found.budget.stopped; }),
    InJson("decisions", "", "What was tried, in that order.", &Discovery::decisions),
    Everywhere(
        "notes", "",
        "What cannot be judged or told apart, and what looks odd in the records.",
        &Discovery::notes)};

}  // namespace mjdiag
