#include "mjdiag/report/tolerance_json.h"

namespace mjdiag {

nlohmann::json ToleranceJson(const TolerantRun& run, const TolerancePlan& plan,
                             const Setup& setup) {
  nlohmann::json axes = nlohmann::json::array();
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    axes.push_back({{"name", setup.control.axes[i].name},
                    {"gain", run.gains[i]},
                    {"least_gain", plan.axes[i].least_gain},
                    {"most_gain", plan.axes[i].most_gain}});
  }
  nlohmann::json faults = nlohmann::json::array();
  for (const Tolerated& fault : run.faults) {
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

}  // namespace mjdiag
