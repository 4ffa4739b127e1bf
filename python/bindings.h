#pragma once
// The parts of the module, in the order in which they are defined: each with the classes
// of one subject.

#include <pybind11/pybind11.h>

namespace mjdiag::python {

void BindRecord(pybind11::module_& module);     // Record
void BindLinear(pybind11::module_& module);     // LinearModel
void BindDiagnosis(pybind11::module_& module);  // Diagnosis, Fault
void BindMonitor(pybind11::module_& module);    // Monitor
void BindDiscovery(pybind11::module_& module);  // Discovery, Cause, Parameter
void BindMachine(pybind11::module_& module);    // Machine, Calibration

}  // namespace mjdiag::python
