#pragma once
// A motion that tells most of a machine whose controllers are not known, as Python has it.

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "mjdiag/studies/excitation/joint_motion_design.h"
#include "python/machine.h"

namespace mjdiag::python {

struct JointMotionObject {
  MachineObject machine;
  JointMotionDesign design;
  std::vector<std::string> notes;  ///< on the record
};

/// @param record         a Record, or the path of one
/// @param limits         joint -> name -> number, or None
/// @param max_frequency  [Hz]; none: what suits the measured motion
/// @param budget         [s]; none: all motions are tried
JointMotionObject ExciteJoints(const MachineObject& machine,
                               const pybind11::object& record,
                               const pybind11::object& limits,
                               std::optional<double> max_frequency,
                               std::optional<double> budget,
                               const pybind11::object& progress);

}  // namespace mjdiag::python
