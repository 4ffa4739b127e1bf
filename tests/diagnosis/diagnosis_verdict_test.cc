#include "mjdiag/diagnosis/diagnosis_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mjdiag {
namespace {

FaultVerdict Fault(const std::string& name, double deviation, double sd,
                   bool detected = true, double healthy = 1.0) {
  FaultVerdict fault;
  fault.name = name;
  fault.value = healthy + deviation;
  fault.deviation = deviation;
  fault.sd = sd;
  fault.detected = detected;
  return fault;
}

DiagnosisResult Found(std::vector<FaultVerdict> faults) {
  DiagnosisResult result;
  result.detected = true;
  result.faults = std::move(faults);
  return result;
}

std::vector<std::string> Names(const std::vector<FaultVerdict>& faults) {
  std::vector<std::string> names;
  names.reserve(faults.size());
  for (const FaultVerdict& fault : faults) names.push_back(fault.name);
  return names;
}

TEST(DiagnosisVerdict, NamesTheMostSignificantFaultFirst) {
  const DiagnosisResult result =
      Found({Fault("zeta_x", 0.2, 1e-3), Fault("eta_z", -0.01, 1e-5)});
  EXPECT_EQ(DiagnosisVerdict(result), "Detected: eta_z = 0.99, zeta_x = 1.2.");
}

TEST(DiagnosisVerdict, LeavesOutFaultsThatTheStrongestDwarfs) {
  // Significances 49, 1000 and 51.
  const DiagnosisResult result =
      Found({Fault("a", 0.049, 1e-3), Fault("b", 1.0, 1e-3), Fault("c", 0.051, 1e-3)});
  EXPECT_EQ(DiagnosisVerdict(result), "Detected: b = 2, c = 1.051.");
}

TEST(DiagnosisVerdict, LeavesOutNoneThatATwinHasToldApart) {
  DiagnosisResult result = Found({Fault("a", 0.049, 1e-3), Fault("b", 1.0, 1e-3)});
  result.by_twin = true;
  EXPECT_EQ(DiagnosisVerdict(result), "Detected: b = 2, a = 1.049.");
}

TEST(DiagnosisVerdict, SaysThatNoFaultExplainsTheRun) {
  DiagnosisResult result = Found({Fault("a", 1.0, 1e-3)});
  result.by_twin = true;
  result.nis = 400.0;
  EXPECT_EQ(DiagnosisVerdict(result),
            "Neither the healthy machine nor its faults explain this run: what is left "
            "has 20.0 times the noise.");
}

TEST(DiagnosisVerdict, LeavesOutFaultsThatReadAsHealthy) {
  const DiagnosisResult result =
      Found({Fault("eta_y", 4e-7, 1e-9), Fault("zeta_x", 0.2, 1e-3),
             Fault("gamma", 1e-6, 1e-8, true, 0.0)});
  EXPECT_EQ(DiagnosisVerdict(result), "Detected: zeta_x = 1.2, gamma = 1e-06.");
}

TEST(DiagnosisVerdict, NamesAFaultAloneHoweverSmallByItsDeviation) {
  const DiagnosisResult result =
      Found({Fault("eta_y", 1e-7, 1e-9), Fault("eta_z", -4e-7, 1e-9)});
  EXPECT_EQ(DiagnosisVerdict(result), "Detected: eta_z = 1 - 4.00e-07.");
}

TEST(DiagnosisVerdict, NamesNoFaultThatIsNotDetected) {
  DiagnosisResult result = Found({Fault("eta_y", 0.5, 1e-3, false)});
  EXPECT_EQ(DiagnosisVerdict(result), "The residual has left its thresholds.");
  result.disturbance.noise_raised = true;
  EXPECT_EQ(DiagnosisVerdict(result), "The sensors are noisier than usual.");
  result.disturbance.tones.emplace_back();
  EXPECT_EQ(DiagnosisVerdict(result), "A periodic disturbance is there.");
}

TEST(RankedFaults, PutsDetectedFaultsFirstAndKeepsAllOfThem) {
  const DiagnosisResult result =
      Found({Fault("a", 1.0, 1.0, false), Fault("b", 0.02, 1e-3), Fault("c", 0.0, 0.0),
             Fault("d", 0.1, 1e-3), Fault("e", 9.0, 1.0, false)});
  EXPECT_THAT(Names(RankedFaults(result)),
              ::testing::ElementsAre("d", "b", "c", "a", "e"));
}

}  // namespace
}  // namespace mjdiag
