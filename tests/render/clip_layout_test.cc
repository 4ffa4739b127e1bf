#include "mjdiag/render/clip_layout.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

struct Box {
  std::string name;
  cv::Rect place;
};

std::vector<Box> TextBoxes(const ClipLayout& layout, const LayoutExtras& extras) {
  std::vector<Box> boxes{{"time", layout.time},
                         {"speed", layout.speed},
                         {"amplification", layout.amplification}};
  for (const PanelLayout& panel : layout.panels) {
    boxes.push_back({"title", panel.title});
    boxes.push_back({"readout", panel.readout});
    if (extras.ghost) boxes.push_back({"ghost", panel.ghost});
    if (extras.legend > 0) boxes.push_back({"legend", panel.legend});
  }
  std::vector<ChartLayout> charts = layout.charts;
  if (layout.residual) {
    charts.push_back(*layout.residual);
    boxes.push_back({"limits", layout.residual->level_labels});
  }
  for (const ChartLayout& chart : charts) {
    boxes.push_back({"caption", chart.caption});
    boxes.push_back({"plot", chart.plot});
    boxes.push_back({"value labels", chart.value_labels});
    boxes.push_back({"time labels", chart.time_labels});
  }
  if (layout.diagnosis) {
    boxes.push_back({"badge", layout.diagnosis->badge});
    boxes.push_back({"heading", layout.diagnosis->heading});
    boxes.push_back({"rows", layout.diagnosis->rows});
    boxes.push_back({"axis labels", layout.diagnosis->axis_labels});
    boxes.push_back({"axis title", layout.diagnosis->axis_title});
  }
  return boxes;
}

struct Case {
  cv::Size size;
  std::size_t panels;
  std::size_t traces;
  LayoutExtras extras;
};

class ClipLayoutOf : public ::testing::TestWithParam<Case> {};

TEST_P(ClipLayoutOf, HasNoOverlappingBoxes) {
  const Case& c = GetParam();
  const ClipLayout layout = LayOutClip(c.size, c.panels, c.traces, c.extras);
  ASSERT_EQ(layout.panels.size(), c.panels);
  ASSERT_EQ(layout.charts.size(), c.traces);
  const std::vector<Box> boxes = TextBoxes(layout, c.extras);
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
  for (const PanelLayout& panel :
       LayOutClip(c.size, c.panels, c.traces, c.extras).panels) {
    EXPECT_EQ(panel.title & panel.view, panel.title);
    EXPECT_EQ(panel.readout & panel.view, panel.readout);
    EXPECT_EQ(panel.ghost & panel.view, panel.ghost);
    EXPECT_EQ(panel.legend & panel.view, panel.legend);
  }
}

TEST_P(ClipLayoutOf, LeavesRoomForReadingsAndClock) {
  const Case& c = GetParam();
  const ClipLayout layout = LayOutClip(c.size, c.panels, c.traces, c.extras);
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
                         ::testing::Values(Case{{1280, 720}, 2, 3, {}},
                                           Case{{640, 360}, 2, 3, {}},
                                           Case{{1920, 1080}, 3, 4, {}},
                                           Case{{640, 360}, 1, 1, {}},
                                           Case{{720, 1280}, 2, 3, {}},
                                           Case{{1280, 720}, 2, 3, {true, false, 1}},
                                           Case{{1280, 720}, 1, 3, {true, true, 2}},
                                           Case{{640, 360}, 2, 2, {true, false, 1}},
                                           Case{{640, 360}, 1, 2, {true, true, 2}},
                                           Case{{640, 360}, 1, 3, {false, true, 2}}));

TEST(ClipLayout, KeepsTheDiagnosisBesideTheViewsAndItsResidualReadable) {
  for (const cv::Size size : {cv::Size(1280, 720), cv::Size(640, 360)}) {
    const std::size_t traces = std::min<std::size_t>(3, MostTraces(size.width, true));
    const ClipLayout layout = LayOutClip(size, 2, traces, {true, false, 1});
    for (const PanelLayout& panel : layout.panels) {
      EXPECT_EQ((panel.view & layout.diagnosis->area).area(), 0);
    }
    Typesetter type;
    const ChartLayout& residual = *layout.residual;
    EXPECT_LE(type.Width("residual [\u00d710^\u22126]", layout.small) +
                  layout.small.em +
                  type.Width("detected at 0.0123 s", {layout.small.em, Weight::kBold}),
              residual.plot.width + residual.level_labels.width);
    EXPECT_LE(type.Width("upper limit", layout.small) + 0.3 * layout.small.em,
              residual.level_labels.width);
    // Eight faults, a line each.
    EXPECT_GE(layout.diagnosis->rows.height, 8 * 1.25 * layout.body.em);
  }
}

TEST(ClipLayout, RefusesSizesThatEncodersOrTextCannotDo) {
  EXPECT_THROW(LayOutClip({1281, 720}, 2, 3), InputError);
  EXPECT_THROW(LayOutClip({1280, 100}, 2, 3), InputError);
  EXPECT_THROW(LayOutClip({640, 360}, 9, 3), InputError);
  EXPECT_THROW(LayOutClip({640, 360}, 2, 9), InputError);
}

}  // namespace
}  // namespace mjdiag
