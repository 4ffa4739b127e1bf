// Nothing on the path of a control callback may allocate.

#include <gtest/gtest.h>

#include "diagnosis/test_design.h"
#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::CountAllocations;

class DiagnosisAllocation : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  }
};

TEST_F(DiagnosisAllocation, IsCounted) {
  EXPECT_GE(CountAllocations([] {
              const VectorXd vector = VectorXd::Ones(10);
              asm volatile("" : : "g"(vector.data()) : "memory");
            }),
            1);
}

TEST_F(DiagnosisAllocation, DoesNotHappenInRunningBank) {
  RunningBank bank(test::StageDesign().bank.filters);
  const VectorXd z = VectorXd::Ones(4);
  EXPECT_EQ(CountAllocations([&] {
              bank.Settle(z);
              for (int k = 0; k < 10; ++k) bank.Step(z);
              bank.Reset();
            }),
            0);
}

TEST_F(DiagnosisAllocation, DoesNotHappenInAnEstimatorOfManyRows) {
  // 28 outputs over order 15: whole products would outgrow what Eigen keeps on the
  // stack.
  constexpr Index kResiduals = 28;
  constexpr Index kFaults = 8;
  const FilterBank filters =
      MakeFilterBank({test::WhiteNoise(kResiduals, 6, 1.0, 1)}, {15, 300.0}, 1 / 8e3);
  FaultEstimator estimator(
      kFaults, MakeResidualNoise(filters, kResiduals, VectorXd::Ones(6), 4), 0.999);
  const VectorXd residuals = VectorXd::Ones(kResiduals);
  const MatrixXd regressors = test::WhiteNoise(kFaults, kResiduals, 1.0, 2);
  VectorXd value(kFaults);
  EXPECT_EQ(CountAllocations([&] {
              for (int k = 0; k < 5; ++k) {
                estimator.Add(residuals, regressors);
                estimator.Solve(value);
              }
            }),
            0);
  EXPECT_GT(value.norm(), 0.0);
}

TEST_F(DiagnosisAllocation, DoesNotHappenInADiagnosisAndItsRecorder) {
  const DiagnosisDesign design = test::StageDesign();
  const MatrixXd signals =
      test::Measured(test::Motion(test::Stage(), test::Drive(1000)), 1);
  // Both starts, and ticks beyond the room of the recorder.
  for (const double start : {0.0, 5e-3}) {
    DiagnosisRecording recording(design, 900, MatrixXd::Zero(test::kRelations, 500));
    std::vector<double> y(2);
    std::vector<double> u(2);
    EXPECT_EQ(CountAllocations([&] {
                for (Index k = 0; k < signals.cols(); ++k) {
                  for (Index i = 0; i < 2; ++i) {
                    const auto at = static_cast<std::size_t>(i);
                    y[at] = signals(i, k) + design.offset[i] + start;
                    u[at] = signals(2 + i, k);
                  }
                  recording.Add(y, u);
                }
              }),
              0);
    EXPECT_GT(recording.monitor.estimator().samples(), 0);
    EXPECT_EQ(recording.recorder.samples(), 900);
  }
}

}  // namespace
}  // namespace mjdiag
