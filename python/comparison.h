#pragma once
// A comparison of a measured record with its simulation, as Python has it.

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/discovery/comparison/comparison.h"
#include "python/machine.h"

namespace mjdiag::python {

struct ComparisonObject {
  Comparison comparison;
  std::vector<std::string> notes;  ///< on how a file became the record
};

/// @param open_loop  whatever controllers it has
/// @param seed       of the noise floor
ComparisonObject CompareRecord(const MachineObject& machine,
                               const pybind11::object& record, bool open_loop,
                               std::uint64_t seed, const pybind11::object& progress);

}  // namespace mjdiag::python
