#include "mjdiag/watch/history_json.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace mjdiag {
namespace {

HistoryValue One(double value) {
  const auto number = static_cast<float>(value);
  return {number, number, number};
}

/// As many digits as a plot shows.
void AppendShort(float value, std::string& text) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.7g", static_cast<double>(value));
  text += digits.data();
}

void AppendColumn(const std::vector<HistoryRow>& rows, std::size_t quantity,
                  float HistoryValue::*part, std::string& text) {
  text += '[';
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k > 0) text += ',';
    AppendShort(rows[k].values[quantity].*part, text);
  }
  text += ']';
}

}  // namespace

std::vector<std::string> HistoryQuantities(const DiagnosisDesign& design) {
  std::vector<std::string> names = {"residual", "integral", "misfit", "missing"};
  for (const std::string& fault : design.FaultNames()) {
    names.push_back(fault);
    names.push_back(fault + " sd");
  }
  return names;
}

std::vector<HistoryValue> HistoryValuesOf(const Finding& look) {
  std::vector<HistoryValue> values = {{static_cast<float>(look.residual.least),
                                       static_cast<float>(look.residual.mean()),
                                       static_cast<float>(look.residual.most)},
                                      One(look.integral),
                                      One(look.result.nis),
                                      One(static_cast<double>(look.missing))};
  for (const FaultVerdict& fault : look.result.faults) {
    // Before the motion has told anything of it, there is no estimate.
    const bool known = std::isfinite(fault.sd);
    values.push_back(known ? One(fault.value) : HistoryValue{});
    values.push_back(known ? One(fault.sd) : HistoryValue{});
  }
  return values;
}

std::string HistoryText(const History& history, std::size_t level, double from) {
  if (level >= kHistoryLevels.size()) return "";
  const std::vector<HistoryRow> rows = history.Rows(level, from);
  std::string text =
      "{\"width\":" + std::to_string(kHistoryLevels[level].width) + ",\"time\":[";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    text += (k > 0 ? "," : "") + std::to_string(std::llround(rows[k].time));
  }
  text += "],\"quantities\":{";
  for (std::size_t i = 0; i < history.quantities().size(); ++i) {
    text += (i > 0 ? "," : "") + nlohmann::json(history.quantities()[i]).dump() +
            ":{\"min\":";
    AppendColumn(rows, i, &HistoryValue::least, text);
    text += ",\"mean\":";
    AppendColumn(rows, i, &HistoryValue::mean, text);
    text += ",\"max\":";
    AppendColumn(rows, i, &HistoryValue::most, text);
    text += '}';
  }
  return text + "}}";
}

}  // namespace mjdiag
