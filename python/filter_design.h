#pragma once
// Filters of a machine as Python has them.

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "mjdiag/plugin/design/design_facts.h"
#include "python/diagnosis.h"

namespace mjdiag::python {

struct FilterDesignObject {
  MachineObject machine;
  std::shared_ptr<const PreparedDiagnosis> prepared;
  DesignFacts facts;

  const DiagnosisDesign& design() const { return prepared->design; }
};

/// @param method  "svd" or "lp"
FilterDesignObject DesignMachine(const MachineObject& machine,
                                 const std::string& method,
                                 const DiagnoseRequest& request,
                                 const pybind11::object& progress);

}  // namespace mjdiag::python
