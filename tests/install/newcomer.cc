// A bonder with a worn x guide, and what its diagnosis says.
#include <exception>
#include <iostream>

#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: newcomer <share/mjdiag/mjcf/ab383>\n";
    return 2;
  }
  try {
    const mjdiag::Machine healthy(mjdiag::ReadSetup(argv[1]));
    const mjdiag::Machine worn = healthy.With({{{"zeta_x", 1.2}}, {}});
    const mjdiag::Excitation motion = mjdiag::DefaultMotion(healthy.setup());

    mjdiag::DiagnosisSource source;
    source.baseline = true;  // the bonder has dry friction
    const mjdiag::PreparedDiagnosis prepared =
        mjdiag::PrepareDiagnosis(healthy, source, motion);
    const mjdiag::Record record = mjdiag::Simulate(worn, motion, {});
    const mjdiag::Diagnosis diagnosis = mjdiag::Diagnose(healthy, prepared, record);
    std::cout << mjdiag::DiagnosisVerdict(diagnosis.result) << "\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
