#include "app/tolerance_output.h"

#include "app/format.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {

std::string DescribeTolerance(const std::vector<Tolerated>& faults) {
  if (faults.empty()) return "nothing to correct\n";
  Table table({"corrected", "by", "value acted on", "since", "until"});
  for (const Tolerated& fault : faults) {
    table.Add({fault.fault, fault.action, Short(fault.value),
               FormatQuantity(fault.since, "s"),
               fault.acting ? "" : FormatQuantity(fault.until, "s")});
  }
  return table.ToString();
}

}  // namespace mjdiag::app
