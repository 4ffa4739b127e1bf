#include "mjdiag/studies/machine_study.h"

namespace mjdiag {
FaultyMachine WithFaults(const Machine& machine, const std::vector<SizedFault>& faults,
                         std::uint64_t seed) {
  RunOptions options;
  options.seed = seed;
  Changes changes;
  for (const SizedFault& fault : faults) {
    if (IsDisturbance(machine.setup(), fault.name)) {
      options.disturbances[fault.name] = fault.value;
    } else {
      changes.faults.push_back({fault.name, fault.value});
    }
  }
  return {machine.With(changes), options};
}

Record RunLinear(const Excitation& motion, const FaultyMachine& faulty) {
  return SimulateLinear(faulty.machine, motion, faulty.options);
}

Record RunOf(const Excitation& motion, const FaultyMachine& faulty, bool linear) {
  return linear ? RunLinear(motion, faulty)
                : Simulate(faulty.machine, motion, faulty.options);
}

double HealthyValue(const Setup& setup, const std::string& fault) {
  return IsDisturbance(setup, fault) ? 0.0 : 1.0;
}

PreparedDiagnosis LinearDiagnosis(const Machine& machine) {
  DiagnosisSource source;
  source.nominal.linear = true;
  return PrepareDiagnosis(machine, source);
}

Detection Look(const PreparedDiagnosis& prepared, const Record& record,
               const std::string& fault) {
  const DiagnosisResult result =
      Conclude(RecordDiagnosis(prepared.design, record, prepared.baseline));
  Detection detection{result.first_detection, result.disturbance.disturbed, false, 0.0};
  for (const FaultVerdict& verdict : result.faults) {
    if (verdict.name != fault) continue;
    detection.estimate = verdict.detected;
    detection.value = verdict.value;
  }
  return detection;
}

}  // namespace mjdiag
