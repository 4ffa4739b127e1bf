#include "mjdiag/render/diagnosis_overlay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

std::string Refusal(const DiagnosisOverlay& overlay, std::size_t runs = 2) {
  return test::MessageOf<InputError>([&] { CheckOverlay(overlay, runs); });
}

TEST(DiagnosisOverlay, IsAcceptedWhenItFitsTogether) {
  EXPECT_NO_THROW(CheckOverlay(test::Overlay(), 2));
}

TEST(DiagnosisOverlay, SaysWhatDoesNotFitTogether) {
  EXPECT_THAT(Refusal(test::Overlay(), 1), HasSubstr("of run 1"));
  DiagnosisOverlay overlay = test::Overlay();
  overlay.residual = Record(1e-3);
  EXPECT_THAT(Refusal(overlay), HasSubstr("no residual"));
  overlay = test::Overlay();
  std::swap(overlay.limit_low, overlay.limit_high);
  EXPECT_THAT(Refusal(overlay), HasSubstr("the lower one first"));
  overlay = test::Overlay();
  overlay.estimates[1].half_width.conservativeResize(3);
  EXPECT_THAT(Refusal(overlay), HasSubstr("\"force\""));
}

TEST(DiagnosisOverlay, KnowsNoEstimateFromTheFuture) {
  DiagnosisOverlay overlay = test::Overlay();
  overlay.estimate_time.array() += 0.005;  // 5, 15, ... ms
  EXPECT_EQ(EstimateAt(overlay, 0.004), std::nullopt);
  EXPECT_EQ(EstimateAt(overlay, 0.005), 0);
  EXPECT_EQ(EstimateAt(overlay, 0.0149), 0);
  EXPECT_EQ(EstimateAt(overlay, 0.015), 1);
  EXPECT_EQ(EstimateAt(overlay, 99.0), 10);
}

TEST(DiagnosisOverlay, TellsTheMomentOfDetectionToTheSample) {
  DiagnosisOverlay overlay = test::Overlay();
  EXPECT_EQ(DetectionText(overlay), "0.041 s");
  overlay.residual = Record(125e-6);
  overlay.detection = 0.01225;
  EXPECT_EQ(DetectionText(overlay), "0.0123 s");
  overlay.detection.reset();
  EXPECT_EQ(DetectionText(overlay), "");
}

}  // namespace
}  // namespace mjdiag
