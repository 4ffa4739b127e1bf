#pragma once
// `mjdiag design --json`: the filters of a machine with what they start from.

#include <nlohmann/json.hpp>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/plugin/design/design_facts.h"

namespace mjdiag {

/// filters.json (filters_file.h) and beside it observability_ranks, states,
/// minimal_degree and, where it was asked for, linear_program {degree, norm,
/// fault_inputs, programs, feasible, objective, defect, angle [rad]}, the last three null
/// where none is feasible.
nlohmann::json DesignJson(const DiagnosisDesign& design, const DesignFacts& facts);

}  // namespace mjdiag
