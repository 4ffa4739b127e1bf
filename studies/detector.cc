#include "mjdiag/studies/detector.h"

#include <algorithm>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

DiagnosisResult ResultOf(const PreparedDiagnosis& prepared, const Record& record) {
  return Conclude(RecordDiagnosis(prepared.design, record, prepared.baseline));
}

}  // namespace

Detector ByResidual(const std::string& name, const PreparedDiagnosis& prepared) {
  const auto alarms = [prepared](const Record& record) {
    return ResultOf(prepared, record).first_detection.has_value();
  };
  return {name,
          [alarms](const Record& record, const std::string&) { return alarms(record); },
          alarms,
          {}};
}

Detector BySpectrum(const Setup& setup, const PreparedDiagnosis& prepared) {
  const auto alarms = [prepared](const Record& record) {
    return ResultOf(prepared, record).disturbance.disturbed;
  };
  return {"spectrum",
          [alarms](const Record& record, const std::string&) { return alarms(record); },
          alarms,
          [setup](const std::string& fault) { return IsDisturbance(setup, fault); }};
}

Detector ByEstimate(const PreparedDiagnosis& prepared) {
  return {"estimate",
          [prepared](const Record& record, const std::string& fault) {
            return std::ranges::any_of(
                ResultOf(prepared, record).faults, [&](const FaultVerdict& verdict) {
                  return verdict.name == fault && verdict.detected;
                });
          },
          [prepared](const Record& record) {
            return std::ranges::any_of(ResultOf(prepared, record).faults,
                                       &FaultVerdict::detected);
          },
          {}};
}

Detector ByTwin(const Machine& machine, bool linear) {
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  return {"twin",
          [machine, linear, names](const Record& record, const std::string& fault) {
            const TwinReading reading = Listen(machine, record, linear);
            for (std::size_t i = 0; i < names.size(); ++i) {
              if (reading.named[i] != (names[i] == fault)) return false;
            }
            return true;
          },
          [machine, linear](const Record& record) {
            const TwinReading reading = Listen(machine, record, linear);
            return std::ranges::any_of(reading.named, [](bool named) { return named; });
          },
          {},
          true};
}

}  // namespace mjdiag
