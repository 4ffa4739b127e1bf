#pragma once
// The parts of the module, each with the classes of one subject, in the order in which
// they are defined: what a function takes has to be known before it, or its signature
// would show a name of C++.

#include <pybind11/pybind11.h>

namespace mjdiag::python {

void BindRecord(pybind11::module_& module);     // Record
void BindLinear(pybind11::module_& module);     // LinearModel
void BindDiagnosis(pybind11::module_& module);  // Diagnosis, Fault
void BindDiscovery(pybind11::module_& module);  // Discovery, Cause, Parameter
void BindComparison(
    pybind11::module_& module);  // Comparison, Mismatch, DisturbanceEstimate
void BindFilterDesign(pybind11::module_& module);     // FilterDesign
void BindTolerance(pybind11::module_& module);        // TolerantRun
void BindExcitation(pybind11::module_& module);       // MotionDesign
void BindJointExcitation(pybind11::module_& module);  // JointMotionDesign
void BindMachine(pybind11::module_& module);          // Machine
void BindMonitor(pybind11::module_& module);          // Monitor
void BindStudy(pybind11::module_& module);            // Study, StudyResult

}  // namespace mjdiag::python
