#include "mjdiag/plugin/runtime/late_faults.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

double ValueOf(const Machine& machine, const std::string& fault) {
  double value = 1.0;
  for (const Fault& change : machine.changes().faults) {
    if (change.name == fault) value *= change.value;
  }
  return value;
}

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
  std::vector<std::pair<Eigen::Index, const Fault*>> order;
  for (const LateFault& late : faults) {
    if (IsDisturbance(machine.setup(), late.fault.name)) continue;
    order.emplace_back(TickOf(late, machine.rates().tick()), &late.fault);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<MachineStage> stages;
  for (const auto& [tick, fault] : order) {
    const Machine& before = stages.empty() ? machine : stages.back().machine;
    Machine now = WithValue(before, *fault);
    if (stages.empty() || stages.back().tick != tick) {
      stages.push_back({tick, std::move(now)});
    } else {
      stages.back().machine = std::move(now);
    }
  }
  return stages;
}

}  // namespace mjdiag
