#pragma once
// A motion that tells most, as Python has it, and the machine that it was designed for.

#include <pybind11/pybind11.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/studies/excitation/motion_design.h"
#include "python/machine.h"

namespace mjdiag::python {

struct MotionDesignObject {
  MachineObject machine;
  MotionDesign design;
};

/// axis -> name -> number, or None. InputError on anything else.
std::map<std::string, AxisLimits> LimitsByAxis(const pybind11::object& given);
/// name -> dict of the limits that there are.
pybind11::dict LimitDict(const std::vector<std::string>& names,
                         const std::vector<AxisLimits>& all);
/// InputError on what is not finite and above 0.
void RequirePositive(const char* what, double value, const char* unit);

/// @param wanted         a name, or several
/// @param limits         axis -> name -> number, or None
/// @param max_frequency  [Hz]; none: a quarter of the control rate
/// @param budget         [s]; none: all motions are tried
MotionDesignObject ExciteMachine(const MachineObject& machine,
                                 const pybind11::object& wanted,
                                 const pybind11::object& limits,
                                 std::optional<double> max_frequency,
                                 const std::string& name, std::optional<double> budget,
                                 const pybind11::object& progress);

}  // namespace mjdiag::python
