// What runs inside a control callback may not allocate: counts calls of malloc.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <vector>

#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/simulate_lti.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MJDIAG_COUNTS_ALLOCATIONS 0
#else
#define MJDIAG_COUNTS_ALLOCATIONS 1
#endif

namespace {
std::atomic<long> allocations{0};
}

#if MJDIAG_COUNTS_ALLOCATIONS
// Eigen and operator new both end here; glibc allows a program to put its own in front.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace mjdiag {
namespace {

/// Keeps the compiler from leaving out an allocation that nothing uses.
void Use(const void* memory) { asm volatile("" : : "g"(memory) : "memory"); }

template <typename Function>
long CountAllocations(const Function& function) {
  const long before = allocations;
  function();
  return allocations - before;
}

class Allocation : public testing::Test {
 protected:
  void SetUp() override {
    if (!MJDIAG_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc belongs to the sanitizer";
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
