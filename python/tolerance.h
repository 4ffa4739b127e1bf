#pragma once
// A fault-tolerant run as Python has it.

#include <memory>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/tolerant_run.h"
#include "python/diagnosis.h"

namespace mjdiag::python {

struct TolerantRunObject {
  std::shared_ptr<const PreparedDiagnosis> prepared;
  TolerancePlan plan;
  TolerantRun run;
  std::vector<std::string> axes;  ///< names, as in plan.axes and run.gains
  std::string json;
};

}  // namespace mjdiag::python
