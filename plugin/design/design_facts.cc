#include "mjdiag/plugin/design/design_facts.h"

#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/effects/kind.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

// Beyond it a plant without parity relations is one without redundancy.
constexpr int kHighestDegree = 40;

constexpr double kLostStiffness = 0.01;  // what is left of a spring

}  // namespace

DesignFacts FactsOf(const Machine& machine, bool linear_programs) {
  DesignFacts facts;
  facts.healthy = machine.linear();
  const SynthesisOptions options = SynthesisOf(machine);
  const StateSpace system = DeltaForm(facts.healthy, options.timing);
  facts.observability_ranks = ObservabilityRanks(system, options.residual.degree);
  facts.states = system.states();
  facts.minimal_degree =
      MinimalDegree(system, UnknownForceEntry(facts.healthy, options), kHighestDegree);
  if (linear_programs)
    facts.linear_program = SolveParityPrograms(machine, facts.healthy);
  return facts;
}

std::vector<ChangedMachine> WithoutStiffness(const Machine& machine) {
  std::vector<ChangedMachine> changed;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    if (KindOf(parameter.kind) != Kind::kCompliance) continue;
    changed.push_back(
        {parameter.name + " = " + AllDigits(kLostStiffness),
         machine.With({{{parameter.name, kLostStiffness}}, {}}).linear()});
  }
  return changed;
}

}  // namespace mjdiag
