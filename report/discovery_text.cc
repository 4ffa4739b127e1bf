#include "mjdiag/report/discovery_text.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mjdiag/discovery/explanations.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/report/cause_text.h"
#include "mjdiag/report/kinds_text.h"
#include "mjdiag/report/mismatch_tables.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

constexpr const char* kNone = "-";
constexpr const char* kUnlisted = "a law that is in no list";
constexpr double kConsidered = 0.05;

std::string Join(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const bool last = i + 1 == items.size();
    text += (i == 0 ? "" : last ? " and " : ", ") + items[i];
  }
  return text;
}

/// "coulomb_friction at load (force 20.39 N)", "zeta_x = 1.2000".
std::string WithValues(const FoundCause& found) {
  if (!found.HasName()) return "a force without a name (" + found.unnamed + ")";
  std::string values;
  for (const CauseParameter& parameter : found.parameters) {
    if (found.cause.effect->IsFault())
      return CauseName(found.cause) + " = " + ValueText(parameter);
    values +=
        (values.empty() ? "" : ", ") + parameter.name + " " + ValueText(parameter);
  }
  return CauseName(found.cause) + (values.empty() ? "" : " (" + values + ")");
}

/// Of a number, how far it is moved, or its factor.
CauseParameter ChangeOf(const CalibratedNumber& number) {
  if (number.shift > 0.0) {
    return {"shift",
            number.shift_unit,
            number.shift * std::log(number.factor),
            0.0,
            number.shift * std::log(number.low),
            number.shift * std::log(number.high)};
  }
  return {"factor", "1", number.factor, 0.0, number.low, number.high};
}

/// "stiffness@X 0.9556 times what the model says".
std::string NumberText(const CalibratedNumber& number) {
  if (number.shift > 0.0) {
    return number.name + " moved by " + ValueText(ChangeOf(number));
  }
  return number.name + " " + ValueText(ChangeOf(number)) + " times what the model says";
}

std::string FoundText(const Discovery& discovery) {
  std::vector<std::string> causes;
  for (const FoundCause& found : discovery.causes) causes.push_back(WithValues(found));
  for (const CalibratedNumber& number : discovery.calibration) {
    if (number.is_found) causes.push_back(NumberText(number));
  }
  return "Found: " + Join(causes) + ".";
}

std::string UnseenText(const Discovery& discovery) {
  const double gain = discovery.gain_validation;
  if (discovery.mismatch_after.validation.empty() || !std::isfinite(gain)) return "";
  std::string text = " On unseen data the mismatch ";
  text += gain < 0.0 ? "rises by " + GainText(-gain) : "falls by " + GainText(gain);
  const std::optional<double> times =
      TimesFloor(discovery.mismatch_after.validation, discovery.noise_floor);
  if (times) text += ", to " + FormatNumber(*times) + " times the noise floor";
  return text + ".";
}

/// ", 12 % of the force that was missing".
std::string ForceLeftText(const Discovery& discovery) {
  if (!discovery.force_left || !std::isfinite(*discovery.force_left)) return "";
  const double percent = 100.0 * *discovery.force_left;
  return ", " + (percent < 1.0 ? "less than 1" : FormatNumber(percent, 2)) +
         " % of the force that was missing";
}

std::string RestText(const Discovery& discovery) {
  // Beside "to 40 times the noise floor" noise explains nothing.
  constexpr double kNoise = 2.0;
  const std::string left = ForceLeftText(discovery);
  const std::optional<double> times =
      TimesFloor(discovery.mismatch_after.validation, discovery.noise_floor);
  if (left.empty() && times && *times > kNoise) return "";
  return left.empty() ? " Noise explains the rest." : " Little is left" + left + ".";
}

std::string ResidualDependenceText(const Discovery& discovery) {
  if (!discovery.unexplained || discovery.unexplained->text.empty()) return "";
  return " " + discovery.unexplained->text;
}

std::string BestAlternative(const FoundCause& found) {
  double others = 1.0 - found.probability - found.none;
  double likeliest = 0.0;
  for (const Alternative& alternative : found.alternatives) {
    if (alternative.indistinguishable) continue;
    others -= alternative.probability;
    likeliest = std::max(likeliest, alternative.probability);
  }
  const FoundCause::NumberInstead* number =
      found.numbers.empty() ? nullptr : &found.numbers.front();
  for (const FoundCause::NumberInstead& one : found.numbers) others -= one.probability;
  if (number != nullptr && number->probability > std::max(likeliest, found.none)) {
    return number->name + ", " + PercentText(100.0 * number->probability);
  }
  if (found.none >= kConsidered && found.none > likeliest) {
    return "nothing, " + PercentText(100.0 * found.none);
  }
  if (others >= kConsidered && others > likeliest) {
    return std::string(kUnlisted) + ", " + PercentText(100.0 * others);
  }
  if (found.alternatives.empty()) return kNone;
  const Alternative& best = found.alternatives.front();
  if (best.indistinguishable) {
    return CauseName(best.cause) + ", alike";
  }
  return CauseName(best.cause) + ", " + PercentText(100.0 * best.probability);
}

/// Ten blocks for a probability of 1.
std::string Bar(double probability) {
  constexpr int kBlocks = 10;
  const double part = std::isfinite(probability) ? probability : 0.0;
  const int full = static_cast<int>(std::lround(kBlocks * std::clamp(part, 0.0, 1.0)));
  std::string bar;
  for (int i = 0; i < kBlocks; ++i) bar += i < full ? "█" : "░";
  return bar;
}

}  // namespace

std::string DiscoveryAnswer(const Discovery& discovery) {
  switch (discovery.verdict) {
    case DiscoveryVerdict::kNoDiscrepancy:
      if (std::ranges::any_of(discovery.calibration, IsOff)) {
        return "Nothing is wrong but numbers of the plant: with them as they are noise "
               "explains the mismatch.";
      }
      return "Nothing is wrong that this record shows: noise explains the mismatch.";
    case DiscoveryVerdict::kExplained:
      return KindsSentence(discovery) + FoundText(discovery) + RestText(discovery) +
             UnseenText(discovery);
    case DiscoveryVerdict::kPartlyExplained:
      return KindsSentence(discovery) + FoundText(discovery) + UnseenText(discovery) +
             (discovery.unexplained || discovery.force_left
                  ? " Something is left" + ForceLeftText(discovery) + "."
                  : " Noise is left.") +
             ResidualDependenceText(discovery);
    case DiscoveryVerdict::kUnexplained:
      return "Something is there that no known cause explains." +
             ResidualDependenceText(discovery);
  }
  return "";
}

Table CauseTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Cause"},
                   {"Site"},
                   {"Parameter"},
                   {"Value", true},
                   {"95 % interval", true},
                   {"Probability", true},
                   {"Best alternative"}};
  for (const FoundCause& found : discovery.causes) {
    if (!found.HasName()) {
      table.rows.push_back({found.cause.name(), found.cause.site, "curve",
                            std::to_string(found.parameters.size()) + " knots", kNone,
                            "no name", kNone});
      continue;
    }
    bool first = true;
    for (const CauseParameter& parameter : found.parameters) {
      std::vector<std::string> row(table.columns.size());
      if (first) {
        row = {found.cause.name(),
               found.cause.site,
               "",
               "",
               "",
               PercentText(100.0 * found.probability),
               BestAlternative(found)};
      }
      first = false;
      row[2] = parameter.name;
      row[3] = ValueText(parameter);
      row[4] = IntervalText(parameter);
      table.rows.push_back(row);
    }
  }
  return table;
}

Table ExplanationTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Probability", true}, {""}, {"Explanation"}};
  const std::vector<CauseSet> explanations = ExplanationsOf(discovery.causes);
  if (explanations.size() < 2) return table;
  for (const CauseSet& explanation : explanations) {
    std::vector<std::string> causes;
    for (const Cause& cause : explanation.causes) causes.push_back(CauseName(cause));
    table.rows.push_back({PercentText(100.0 * explanation.probability),
                          Bar(explanation.probability), Join(causes)});
  }
  return table;
}

Table CalibrationTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Number of the plant"},
                   {"Times what the model says", true},
                   {"95 % interval", true},
                   {"Known beforehand to", true}};
  for (const CalibratedNumber& number : discovery.calibration) {
    if (!IsOff(number)) continue;
    const CauseParameter change = ChangeOf(number);
    const bool is_moved = number.shift > 0.0;
    table.rows.push_back(
        {number.name, (is_moved ? "moved by " : "") + ValueText(change),
         IntervalText(change),
         is_moved ? FormatQuantity(number.shift * number.doubt, number.shift_unit)
                  : PercentText(100.0 * number.doubt)});
  }
  return table;
}

Table MomentTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"What a joint carries, first moment of mass about it"},
                   {"Model", true},
                   {"Record", true},
                   {"95 % interval", true}};
  for (const CalibratedMoment& moment : discovery.moments) {
    if (!IsMoved(moment)) continue;
    const CauseParameter found{"moment", "kg m",     moment.value,
                               0.0,      moment.low, moment.high};
    const CauseParameter model{"moment", "kg m", moment.model, 0.0, 0.0, 0.0};
    table.rows.push_back({moment.joint + ", along " + moment.axis + " of its body",
                          ValueText(model), ValueText(found), IntervalText(found)});
  }
  return table;
}

Table ResistanceTable(const Discovery& discovery) {
  Table table;
  table.columns = {
      {"Joint"}, {"Dry friction", true}, {"Viscous", true}, {"Resistance at a speed"}};
  constexpr double kLeastStep = 0.1;  // of the largest
  for (const FoundResistance& one : discovery.resistances) {
    const auto text = [](const FoundResistance::Span& span, const std::string& unit) {
      const CauseParameter value{"", unit, span.value, 0.0, span.low, span.high};
      return ValueText(value) + " (" + IntervalText(value) + ")";
    };
    // Speeds at which it is another one.
    std::string curve;
    double last = 0.0;
    const double step = kLeastStep * one.force.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < one.speeds.size(); ++i) {
      const bool is_end = i == 0 || i + 1 == one.speeds.size();
      if (!is_end && std::abs(one.force[i] - last) < step) continue;
      last = one.force[i];
      curve += (curve.empty() ? "" : ", ") + FormatQuantity(last, one.ForceUnit()) +
               " at " + FormatQuantity(one.speeds[i], one.SpeedUnit());
    }
    table.rows.push_back({one.site, text(one.dry, one.ForceUnit()),
                          text(one.viscous, one.ViscousUnit()), curve});
  }
  return table;
}

Table DecisionTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Tried"}, {"Difference", true}, {"What came of it"}};
  for (const Decision& one : discovery.decisions) {
    table.rows.push_back({one.tried, FormatNumber(one.score), one.why});
  }
  return table;
}

Table CandidateTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Cause"}, {"Candidate"}, {""}, {"Probability", true}, {"Remark"}};
  for (const FoundCause& found : discovery.causes) {
    if (!found.HasName()) continue;  // nothing competes with it
    const std::string name = CauseName(found.cause);
    table.rows.push_back({name, name, Bar(found.probability),
                          PercentText(100.0 * found.probability), "found"});
    for (const Alternative& alternative : found.alternatives) {
      table.rows.push_back(
          {"", CauseName(alternative.cause), Bar(alternative.probability),
           PercentText(100.0 * alternative.probability),
           alternative.indistinguishable ? "no measurement tells them apart" : ""});
    }
    for (const FoundCause::NumberInstead& one : found.numbers) {
      table.rows.push_back({"", one.name, Bar(one.probability),
                            PercentText(100.0 * one.probability),
                            "a number of the plant"});
    }
    if (found.none >= kConsidered) {
      table.rows.push_back(
          {"", "nothing", Bar(found.none), PercentText(100.0 * found.none), ""});
    }
  }
  return table;
}

}  // namespace mjdiag
