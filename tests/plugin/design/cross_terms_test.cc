// Large faults of the wire bonder on its linear plant, over a quarter of a second.

#include "mjdiag/plugin/design/cross_terms.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mjdiag/plugin/design/monitor_observer.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

class CrossTerms : public testing::Test {
 protected:
  CrossTerms()
      : machine_(test::Bonder({"diagnosis.thresholds.trajectories=[]",
                               "trajectories.multi.duration=0.25"})),
        design_(DesignFilters(machine_)),
        motion_(FollowTrajectory(machine_.setup(),
                                 machine_.setup().trajectories.Find("multi"))) {
    runs_.linear = true;
    runs_.runs = 3;
    design_.limits = CalibrateLimits(design_, machine_, runs_);
  }

  /// Of a run in noise that none of the healthy runs has.
  DiagnosisResult Diagnosed(const std::vector<Fault>& faults) const {
    DiagnosisRecording recording(design_, motion_.samples());
    MonitorObserver observer(recording);
    RunOptions options;
    options.seed = 7;
    RunWith(machine_.With({faults, {}}), motion_, observer, options, true);
    return Conclude(recording);
  }
  DiagnosisResult WithoutCrossTerms(DiagnosisResult result) const {
    const Eigen::MatrixXd no_baseline;
    RemoveCrossTerms(result, design_, machine_, {motion_, no_baseline, 0, runs_});
    return result;
  }
  static const FaultVerdict& Of(const DiagnosisResult& result,
                                const std::string& name) {
    return *std::ranges::find(result.faults, name, &FaultVerdict::name);
  }
  static std::vector<std::string> Detected(const DiagnosisResult& result) {
    std::vector<std::string> names;
    for (const FaultVerdict& fault : result.faults) {
      if (fault.detected) names.push_back(fault.name);
    }
    return names;
  }

  Machine machine_;
  DiagnosisDesign design_;
  Excitation motion_;
  NominalRuns runs_;
};

TEST_F(CrossTerms, OfALargeFaultAreNotDetectedAsFaults) {
  const DiagnosisResult raw = Diagnosed({{"zeta_x", 1.5}});
  const std::vector<std::string> before = Detected(raw);
  ASSERT_GT(before.size(), 1) << "the fault leaks into no other estimate";
  const DiagnosisResult result = WithoutCrossTerms(raw);
  EXPECT_EQ(Detected(result), std::vector<std::string>{"zeta_x"});
  for (const std::string& name : before) {
    EXPECT_EQ(Of(result, name).cross_term, name != "zeta_x") << name;
  }
}

TEST_F(CrossTerms, GiveTheLargeFaultTheSizeThatExplainsItsEstimate) {
  const DiagnosisResult raw = Diagnosed({{"zeta_x", 3.0}});
  const FaultVerdict before = Of(raw, "zeta_x");
  const FaultVerdict after = Of(WithoutCrossTerms(raw), "zeta_x");
  EXPECT_GT(std::abs(before.value - 3.0), 20.0 * before.sd);
  EXPECT_NEAR(after.value, 3.0, 5.0 * after.sd);
  EXPECT_DOUBLE_EQ(after.value - 1.0, after.deviation);
  EXPECT_DOUBLE_EQ(after.ci95.max - after.ci95.min, before.ci95.max - before.ci95.min);
}

TEST_F(CrossTerms, LeaveASecondFaultDetected) {
  const DiagnosisResult result =
      WithoutCrossTerms(Diagnosed({{"zeta_x", 1.5}, {"eta_y", 0.99}}));
  const std::vector<std::string> expected{"zeta_x", "eta_y"};
  EXPECT_EQ(Detected(result), expected);
  EXPECT_NEAR(Of(result, "eta_y").value, 0.99, 1e-4);
}

TEST_F(CrossTerms, DoNotTouchAHealthyMachine) {
  const DiagnosisResult raw = Diagnosed({});
  const DiagnosisResult result = WithoutCrossTerms(raw);
  ASSERT_TRUE(Detected(raw).empty());
  for (std::size_t i = 0; i < raw.faults.size(); ++i) {
    EXPECT_EQ(result.faults[i].value, raw.faults[i].value) << raw.faults[i].name;
    EXPECT_FALSE(result.faults[i].cross_term) << raw.faults[i].name;
  }
}

}  // namespace
}  // namespace mjdiag
