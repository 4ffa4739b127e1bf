#include "mjdiag/render/clip_layout.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

struct Box {
  std::string name;
  cv::Rect place;
};

std::vector<Box> TextBoxes(const ClipLayout& layout) {
  std::vector<Box> boxes{{"time", layout.time},
                         {"speed", layout.speed},
                         {"amplification", layout.amplification}};
  for (const PanelLayout& panel : layout.panels) {
    boxes.push_back({"title", panel.title});
    boxes.push_back({"readout", panel.readout});
  }
  for (const ChartLayout& chart : layout.charts) {
    boxes.push_back({"caption", chart.caption});
    boxes.push_back({"plot", chart.plot});
    boxes.push_back({"value labels", chart.value_labels});
    boxes.push_back({"time labels", chart.time_labels});
  }
  return boxes;
}

struct Case {
  cv::Size size;
  std::size_t panels;
  std::size_t traces;
};

class ClipLayoutOf : public ::testing::TestWithParam<Case> {};

TEST_P(ClipLayoutOf, HasNoOverlappingBoxes) {
  const Case& c = GetParam();
  const ClipLayout layout = LayOutClip(c.size, c.panels, c.traces);
  ASSERT_EQ(layout.panels.size(), c.panels);
  ASSERT_EQ(layout.charts.size(), c.traces);
  const std::vector<Box> boxes = TextBoxes(layout);
  const cv::Rect picture({0, 0}, c.size);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_GT(boxes[i].place.area(), 0) << boxes[i].name;
    EXPECT_EQ(boxes[i].place & picture, boxes[i].place) << boxes[i].name;
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      EXPECT_EQ((boxes[i].place & boxes[j].place).area(), 0)
          << boxes[i].name << " and " << boxes[j].name;
    }
  }
}

TEST_P(ClipLayoutOf, KeepsTitleAndReadoutInsideTheirView) {
  const Case& c = GetParam();
  for (const PanelLayout& panel : LayOutClip(c.size, c.panels, c.traces).panels) {
    EXPECT_EQ(panel.title & panel.view, panel.title);
    EXPECT_EQ(panel.readout & panel.view, panel.readout);
  }
}

TEST_P(ClipLayoutOf, LeavesRoomForReadingsAndClock) {
  const Case& c = GetParam();
  const ClipLayout layout = LayOutClip(c.size, c.panels, c.traces);
  Typesetter type;
  EXPECT_LE(type.Width("x error \u2212888 \u00b5rad", layout.body),
            layout.panels[0].readout.width - 2 * layout.margin);
  EXPECT_LE(type.Width("t = 8888.8 ms", {layout.body.em, Weight::kBold}),
            layout.time.width);
  EXPECT_LE(type.Width("8000\u00d7 slower", layout.small), layout.speed.width);
  EXPECT_LE(type.Width("\u221288.8", layout.small),
            layout.charts[0].value_labels.width);
  EXPECT_GT(layout.charts[0].plot.height, 30);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ClipLayoutOf,
                         ::testing::Values(Case{{1280, 720}, 2, 3},
                                           Case{{640, 360}, 2, 3},
                                           Case{{1920, 1080}, 3, 4},
                                           Case{{640, 360}, 1, 1},
                                           Case{{720, 1280}, 2, 3}));

TEST(ClipLayout, RefusesSizesThatEncodersOrTextCannotDo) {
  EXPECT_THROW(LayOutClip({1281, 720}, 2, 3), InputError);
  EXPECT_THROW(LayOutClip({1280, 100}, 2, 3), InputError);
  EXPECT_THROW(LayOutClip({640, 360}, 9, 3), InputError);
  EXPECT_THROW(LayOutClip({640, 360}, 2, 9), InputError);
}

}  // namespace
}  // namespace mjdiag
