#include "mjdiag/report/design_json.h"

#include "mjdiag/diagnosis/filters_file.h"

namespace mjdiag {
namespace {

nlohmann::json ToJson(const ParityProgramFacts& facts) {
  const bool found = facts.feasible > 0;
  return {{"degree", facts.degree},
          {"norm", facts.norm},
          {"fault_inputs", facts.fault_inputs},
          {"programs", facts.programs},
          {"feasible", facts.feasible},
          {"objective", found ? nlohmann::json(facts.objective) : nlohmann::json()},
          {"defect", found ? nlohmann::json(facts.defect) : nlohmann::json()},
          {"angle", found ? nlohmann::json(facts.angle) : nlohmann::json()}};
}

}  // namespace

nlohmann::json DesignJson(const DiagnosisDesign& design, const DesignFacts& facts) {
  auto document = nlohmann::json::parse(FiltersJson(design));
  document["observability_ranks"] = facts.observability_ranks;
  document["states"] = facts.states;
  document["minimal_degree"] = facts.minimal_degree;
  if (facts.linear_program) document["linear_program"] = ToJson(*facts.linear_program);
  return document;
}

}  // namespace mjdiag
