#include "mjdiag/report/mismatch_tables.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

constexpr const char* kNoFigure = "-";

using Errors = std::map<std::string, double>;

std::string At(const Errors& values, const std::string& name,
               const std::function<std::string(double)>& format) {
  const auto found = values.find(name);
  return found == values.end() ? kNoFigure : format(found->second);
}

/// A column for every signal that any step has, one row a step.
void AddErrors(Table& table, const std::vector<LadderStep>& ladder,
               Errors LadderStep::*errors) {
  std::set<std::string> names;
  for (const LadderStep& step : ladder) {
    for (const auto& [name, percent] : step.*errors) names.insert(name);
  }
  for (const std::string& name : names) {
    table.columns.push_back({name, true});
    for (std::size_t i = 0; i < ladder.size(); ++i) {
      table.rows[i].push_back(At(ladder[i].*errors, name, PercentText));
    }
  }
}

/// Channels in the order of the comparison, then those that only have figures.
std::vector<std::string> ChannelsOf(const Discovery& discovery) {
  std::vector<std::string> names;
  if (discovery.Fitted() != nullptr) {
    for (const ChannelMismatch& channel : discovery.Fitted()->before.channels) {
      names.push_back(channel.name);
    }
  }
  for (const auto& [name, floor] : discovery.noise_floor) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

std::string FactorText(const FaultLimit& limit) {
  const double factor = limit.before / limit.after;
  return std::isfinite(factor) ? FormatNumber(factor) : kNoFigure;
}

}  // namespace

std::string PercentText(double percent) { return FormatNumber(percent) + " %"; }

std::optional<double> TimesFloor(const Errors& rms, const Errors& floor) {
  double sum = 0.0;
  int channels = 0;
  for (const auto& [name, value] : rms) {
    const auto found = floor.find(name);
    if (found == floor.end() || !(found->second > 0.0)) continue;
    sum += value * value / (found->second * found->second);
    ++channels;
  }
  if (channels == 0) return std::nullopt;
  return std::sqrt(sum / channels);
}

Table LadderTable(const Discovery& discovery) {
  Table table;
  table.columns = {
      {"Added"}, {"Rest over noise, fitted", true}, {"Rest over noise, unseen", true}};
  for (const LadderStep& step : discovery.ladder) {
    table.rows.push_back(
        {step.added, FormatNumber(step.train), FormatNumber(step.held_out)});
  }
  AddErrors(table, discovery.ladder, &LadderStep::error_percent);
  return table;
}

Table ValidationLadderTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Added"}};
  const auto& ladder = discovery.ladder;
  if (std::all_of(ladder.begin(), ladder.end(), [](const LadderStep& step) {
        return step.validation_percent.empty();
      })) {
    return table;
  }
  for (const LadderStep& step : ladder) table.rows.push_back({step.added});
  AddErrors(table, ladder, &LadderStep::validation_percent);
  return table;
}

Table MismatchTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Channel"},
                   {"Noise floor", true},
                   {"Fitted, before", true},
                   {"after", true},
                   {"Unseen, before", true},
                   {"after", true},
                   {"Times the floor", true}};
  const Discovery::Figures& before = discovery.mismatch_before;
  const Discovery::Figures& after = discovery.mismatch_after;
  for (const std::string& name : ChannelsOf(discovery)) {
    const auto found = discovery.unit.find(name);
    const std::string unit = found == discovery.unit.end() ? "" : found->second;
    const auto quantity = [&unit](double rms) { return FormatQuantity(rms, unit); };
    const auto times = [&](double rms) {
      const auto floor = discovery.noise_floor.find(name);
      if (floor == discovery.noise_floor.end() || !(floor->second > 0.0))
        return std::string(kNoFigure);
      return FormatNumber(rms / floor->second);
    };
    table.rows.push_back(
        {name, At(discovery.noise_floor, name, quantity),
         At(before.train, name, quantity), At(after.train, name, quantity),
         At(before.validation, name, quantity), At(after.validation, name, quantity),
         At(after.validation, name, times)});
  }
  return table;
}

Table RecordTable(const Discovery& discovery) {
  Table table;
  if (discovery.records.size() < 2) return table;
  table.columns = {{"Record"},      {"Fitted"},
                   {"Channel"},     {"Mean absolute, before", true},
                   {"after", true}, {"Fit, before", true},
                   {"after", true}};
  for (const RecordReplay& replay : discovery.records) {
    for (std::size_t i = 0; i < replay.before.channels.size(); ++i) {
      const ChannelMismatch& before = replay.before.channels[i];
      const ChannelMismatch& after = replay.after.channels[i];
      table.rows.push_back({replay.name, replay.seen ? "yes" : "no", before.name,
                            FormatQuantity(before.mae, before.unit),
                            FormatQuantity(after.mae, after.unit),
                            PercentText(before.fit_percent),
                            PercentText(after.fit_percent)});
    }
  }
  return table;
}

Table FaultLimitTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Fault"},
                   {"Smallest seen, plant as given", true},
                   {"extended plant", true},
                   {"Times smaller", true}};
  for (const FaultLimit& limit : discovery.fault_limits) {
    table.rows.push_back({limit.fault, PercentText(100.0 * limit.before),
                          PercentText(100.0 * limit.after), FactorText(limit)});
  }
  return table;
}

}  // namespace mjdiag
