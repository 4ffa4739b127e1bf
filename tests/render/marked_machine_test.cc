#include "mjdiag/render/marked_machine.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {
namespace {

FaultParameter Fault(const Machine& machine, const std::string& name) {
  for (const FaultParameter& fault : FaultParameters(machine.plant())) {
    if (fault.name == name) return fault;
  }
  throw std::runtime_error("no fault " + name);
}

std::string BodyNames(const Machine& machine, const std::string& fault) {
  std::string names;
  for (const int body : BodiesOf(machine.plant(), Fault(machine, fault))) {
    names += std::string(mj_id2name(&machine.plant(), mjOBJ_BODY, body)) + " ";
  }
  return names;
}

/// Pixels that are plainly redder than anything else.
int RedPixels(const std::string& png) {
  const std::vector<std::uint8_t> bytes(png.begin(), png.end());
  const cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
  int count = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& bgr = picture.at<cv::Vec3b>(y, x);
      count += bgr[2] > 90 && bgr[2] > 2 * bgr[1] && bgr[2] > 3 * bgr[0] ? 1 : 0;
    }
  }
  return count;
}

TEST(MarkedMachine, MarksWhatJointsCarryAndActuatorsPush) {
  const Machine bonder(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383"));
  EXPECT_EQ(BodyNames(bonder, "zeta_x"), BodyNames(bonder, "eta_x"));
  EXPECT_NE(BodyNames(bonder, "zeta_x"), BodyNames(bonder, "zeta_y"));
  EXPECT_FALSE(BodyNames(bonder, "beta_x").empty());
}

TEST(MarkedMachine, TheMarkIsSeenAndOnlyWhereItIsWanted) {
  const Machine bonder(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383"));
  SceneOptions scene;
  scene.width = 320;
  scene.height = 240;
  scene.camera = "machine";
  const std::vector<int> stage = BodiesOf(bonder.plant(), Fault(bonder, "zeta_x"));
  const int marked = RedPixels(DrawMarked(bonder.plant(), bonder.rest(), stage, scene));
  const int plain = RedPixels(DrawMarked(bonder.plant(), bonder.rest(), {}, scene));
  EXPECT_GT(marked, 500);
  EXPECT_LT(plain, 50);
}

}  // namespace
}  // namespace mjdiag
