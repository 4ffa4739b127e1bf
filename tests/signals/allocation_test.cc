// What runs inside a control callback may not allocate: counts calls of malloc.

#include <gtest/gtest.h>

#include <vector>

#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/simulate_lti.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using test::CountAllocations;

/// Keeps the compiler from leaving out an allocation that nothing uses.
void Use(const void* memory) { asm volatile("" : : "g"(memory) : "memory"); }

class Allocation : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  }
};

TEST_F(Allocation, IsCounted) {
  EXPECT_GE(CountAllocations([] { Use(Eigen::VectorXd(10).data()); }), 1);
  EXPECT_GE(CountAllocations([] { Use(std::vector<double>(10).data()); }), 1);
}

TEST_F(Allocation, DoesNotHappenInLtiStepper) {
  constexpr Eigen::Index kStates = 60;
  StateSpace system;
  system.A = 0.01 * Eigen::MatrixXd::Random(kStates, kStates);
  system.B = Eigen::MatrixXd::Random(kStates, 7);
  system.C = Eigen::MatrixXd::Random(5, kStates);
  system.D = Eigen::MatrixXd::Random(5, 7);
  system.sample_time = 1.0;
  LtiStepper stepper(system);
  const std::vector<double> initial(kStates, 1.0);
  const std::vector<double> input(7, 1.0);
  std::vector<double> output(5);
  EXPECT_EQ(CountAllocations([&] {
              stepper.Reset(initial);
              for (int k = 0; k < 10; ++k) stepper.Step(input, output);
              stepper.Reset();
            }),
            0);
}

TEST_F(Allocation, DoesNotHappenInSectionFilter) {
  SectionFilter filter(DigitalButterworth(FilterKind::kLowPass, 7, 50.0, 1.0 / 8000.0));
  double sum = 0.0;
  EXPECT_EQ(CountAllocations([&] {
              filter.Settle(1.0);
              for (int k = 0; k < 10; ++k) sum += filter.Update(1.0);
              filter.Reset();
            }),
            0);
  EXPECT_NEAR(sum, 10.0, 1e-6);
}

}  // namespace
}  // namespace mjdiag
