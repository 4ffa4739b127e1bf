#include "app/tolerance_output.h"

#include "app/format.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {

std::string DescribeTolerance(const Reconfiguration& reconfiguration,
                              const Setup& setup) {
  const std::vector<Tolerated> tolerated = Summarise(reconfiguration, setup);
  if (tolerated.empty()) return "nothing to correct\n";
  Table table({"corrected", "by", "value acted on", "since", "until"});
  for (const Tolerated& fault : tolerated) {
    table.Add({fault.fault, fault.action, Short(fault.value),
               FormatQuantity(fault.since, "s"),
               fault.acting ? "" : FormatQuantity(fault.until, "s")});
  }
  return table.ToString();
}

nlohmann::json ToleranceJson(const Reconfiguration& reconfiguration,
                             const TolerancePlan& plan, const Setup& setup) {
  nlohmann::json axes = nlohmann::json::array();
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    axes.push_back({{"name", setup.control.axes[i].name},
                    {"gain", reconfiguration.corrections()[i].gain},
                    {"least_gain", plan.axes[i].least_gain},
                    {"most_gain", plan.axes[i].most_gain}});
  }
  nlohmann::json faults = nlohmann::json::array();
  for (const Tolerated& fault : Summarise(reconfiguration, setup)) {
    faults.push_back(
        {{"name", fault.fault},
         {"action", fault.action},
         {"value", fault.value},
         {"since", fault.since},
         {"acting", fault.acting},
         {"until", fault.acting ? nlohmann::json() : nlohmann::json(fault.until)}});
  }
  return {{"time_constant", plan.options.time_constant},
          {"sigmas", plan.options.sigmas},
          {"loop_radius", plan.margins.healthy_radius},
          {"largest_loop_radius", plan.margins.largest_radius},
          {"axes", axes},
          {"faults", faults}};
}

}  // namespace mjdiag::app
