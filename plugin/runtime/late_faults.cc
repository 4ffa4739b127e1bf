#include "mjdiag/plugin/runtime/late_faults.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

using Eigen::Index;

double ValueOf(const Machine& machine, const std::string& fault) {
  double value = 1.0;
  for (const Fault& change : machine.changes().faults) {
    if (change.name == fault) value *= change.value;
  }
  return value;
}

/// One late fault, in ticks.
struct Change {
  Index tick = 0;
  Index ticks = 0;  // in which it becomes that; 0: at once
  double value = 1.0;
};

Change ChangeOf(const LateFault& late, const Machine& machine) {
  const double sample_time = machine.rates().tick();
  const Index tick = TickOf(late, sample_time);
  if (!(late.growth >= 0.0) || !std::isfinite(late.growth)) {
    throw InputError("fault " + late.fault.name, "grows in no time", "seconds >= 0");
  }
  const auto ticks = static_cast<Index>(std::llround(late.growth / sample_time));
  if (ticks > 0 && IsDisturbance(machine.setup(), late.fault.name)) {
    throw InputError("fault " + late.fault.name, "is a disturbance that grows",
                     "one that appears at once");
  }
  // Complains of names and values that there are not.
  if (!IsDisturbance(machine.setup(), late.fault.name))
    machine.With({{late.fault}, {}});
  return {tick, ticks, late.fault.value};
}

/// The values of a fault parameter over time, which may jump.
class FaultCourse {
 public:
  /// @param changes  in the order of time
  FaultCourse(const std::vector<Change>& changes, double at_start)
      : changes_(changes), at_start_(at_start) {}

  /// The value in which the time before a tick ends.
  double Until(Index tick) const { return At(tick, tick - 1); }
  /// That with which the time from the tick on begins.
  double From(Index tick) const { return At(tick, tick); }

 private:
  /// Of the changes that have begun by then.
  double At(Index tick, Index begun) const {
    double value = at_start_;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      const Change& change = changes_[i];
      if (change.tick > begun) break;
      Index end = tick;
      if (i + 1 < changes_.size()) end = std::min(end, changes_[i + 1].tick);
      const Index passed = end - change.tick;
      value = passed >= change.ticks
                  ? change.value
                  : value + (change.value - value) * static_cast<double>(passed) /
                                static_cast<double>(change.ticks);
    }
    return value;
  }

  const std::vector<Change>& changes_;
  double at_start_;
};

Machine WithValue(const Machine& machine, const Fault& fault) {
  const double now = ValueOf(machine, fault.name);
  if (now == 0.0) {
    throw InputError("fault " + fault.name, "is 0 and cannot become anything else",
                     "a value above 0 before it");
  }
  return machine.With({{{fault.name, fault.value / now}}, {}});
}

}  // namespace

Eigen::Index TickOf(const LateFault& fault, double sample_time) {
  if (!(fault.time >= 0.0) || !std::isfinite(fault.time)) {
    throw InputError("fault " + fault.fault.name, "appears at no time of the run",
                     "seconds >= 0");
  }
  return static_cast<Eigen::Index>(std::llround(fault.time / sample_time));
}

std::vector<MachineStage> StagesOf(const Machine& machine,
                                   std::span<const LateFault> faults) {
  std::map<std::string, std::vector<Change>> changes;
  std::set<Index> events;
  for (const LateFault& late : faults) {
    const Change change = ChangeOf(late, machine);
    if (IsDisturbance(machine.setup(), late.fault.name)) continue;
    changes[late.fault.name].push_back(change);
    events.insert({change.tick, change.tick + change.ticks});
  }
  for (auto& [name, of_one] : changes) {
    std::ranges::stable_sort(of_one, {}, &Change::tick);
  }
  std::vector<MachineStage> stages;
  const auto become = [&](Index tick, Index ticks, const auto& course_at) {
    const Machine& before = stages.empty() ? machine : stages.back().machine;
    Machine now = before;
    bool changed = false;
    for (const auto& [name, of_one] : changes) {
      const double value = course_at(FaultCourse(of_one, ValueOf(machine, name)));
      if (value == ValueOf(now, name)) continue;
      now = WithValue(now, {name, value});
      changed = true;
    }
    if (changed || ticks == 0) stages.push_back({tick, std::move(now), ticks});
  };
  // Straight lines between the times at which something begins or ends.
  for (auto event = events.begin(); event != events.end(); ++event) {
    const Index tick = *event;
    become(tick, 0, [=](const FaultCourse& course) { return course.From(tick); });
    if (const auto next = std::next(event); next != events.end()) {
      const Index end = *next;
      become(tick, end - tick,
             [=](const FaultCourse& course) { return course.Until(end); });
    }
  }
  return stages;
}

LateFault ParseLateFault(std::string_view text) {
  constexpr auto kNone = std::string_view::npos;
  const std::size_t equals = text.find('=');
  const std::string_view rest =
      equals == kNone ? std::string_view{} : text.substr(equals + 1);
  const std::size_t at = rest.find('@');
  const auto value = ParseNumber(rest.substr(0, at));
  const auto time = at == kNone ? 0.0 : ParseNumber(rest.substr(at + 1));
  if (!value || !time) {
    throw InputError("--fault '" + std::string(text) + "'", "no number",
                     "<name>=<value> or <name>=<value>@<seconds>");
  }
  return {{std::string(text.substr(0, equals)), *value}, *time};
}

}  // namespace mjdiag
