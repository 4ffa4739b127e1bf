#include "mjdiag/render/machine_views.h"

#include <algorithm>

#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/render/palette.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// How large the largest amplified deviation of a group comes out.
constexpr double kDrawnShare = 0.05;  // of the picture's height
constexpr double kGhostShare = 0.10;  // the same, where it has to be told from a ghost
constexpr double kDrawnAngle = 0.06;  // [rad]
constexpr double kApart = 0.008;      // of the picture's height: worth a ghost
constexpr int kComparedTimes = 100;   // at which poses are compared for the ghost

SceneOptions ViewOptions(const PictureOptions& options, const ClipLayout& layout) {
  // Columns may differ by a pixel; the renderer serves the widest.
  SceneOptions scene{0, layout.panels[0].view.height, options.camera, options.smoothing,
                     options.shadows};
  for (const PanelLayout& panel : layout.panels) {
    scene.width = std::max(scene.width, panel.view.width);
  }
  return scene;
}

void CheckGhost(bool ghost, std::size_t runs) {
  if (!ghost || runs == 2) return;
  throw InputError("ghost", "of " + std::to_string(runs) + " runs",
                   "two: the healthy one and one that differs from it");
}

}  // namespace

MachineViews::MachineViews(const mjModel& model, std::span<const Record* const> records,
                           TimeRange range, const PictureOptions& options,
                           const ClipLayout& layout)
    : model_(model),
      records_(records),
      range_(range),
      scene_(model, ViewOptions(options, layout)),
      data_(MakeData(model)),
      ghost_data_(MakeData(model)) {
  CheckGhost(options.ghost, records.size());
  const double view_height = ViewHeightAtStart();
  const double share = options.ghost ? kGhostShare : kDrawnShare;
  amplification_.emplace(DrawnJoints(model), *records[0], records, range,
                         AmplificationOptions{share * view_height, kDrawnAngle,
                                              options.amplify, options.amplify_all});
  if (options.ghost) ghost_ = FindGhost(view_height);
  const std::optional<int> site = PathSite(model, options.path_site);
  if (!site) return;
  path_site_ = ElementName(model, mjOBJ_SITE, *site);
  for (const Record* record : records) {
    paths_.push_back(DrawnPath(model, *site, *amplification_, *record, range, *data_));
  }
}

// Of the machine as it truly stands at the first moment, without amplification.
double MachineViews::ViewHeightAtStart() {
  const AmplificationOptions as_is{0.0, 0.0, {}, 1.0};
  const Amplification truth(DrawnJoints(model_), *records_[0], records_, range_, as_is);
  SetPositions(model_, truth.DrawnPositions(*records_[0], range_.begin), *data_);
  return scene_.ViewHeight(*data_);
}

// Bodies that stay together with their ghost in the whole clip have none.
Ghost MachineViews::FindGhost(double view_height) {
  BodyDistances distances(model_);
  for (int i = 0; i <= kComparedTimes; ++i) {
    const double time = range_.begin + (range_.end - range_.begin) * i / kComparedTimes;
    SetPose(records_.size() - 1, time, *data_);
    SetPose(0, time, *ghost_data_);
    distances.Compare(*data_, *ghost_data_);
  }
  Ghost ghost;
  ghost.bodies = distances.AtLeast(kApart * view_height);
  const cv::Scalar rgb = palette::OfRun(0);
  for (int c = 0; c < 3; ++c) {
    ghost.rgb[static_cast<std::size_t>(c)] = static_cast<float>(rgb[c] / 255.0);
  }
  return ghost;
}

void MachineViews::SetPose(std::size_t run, double time, mjData& data) const {
  SetPositions(model_, amplification_->DrawnPositions(*records_[run], time), data);
}

std::size_t MachineViews::RunOf(std::size_t panel) const {
  return ghost_ ? records_.size() - 1 : panel;
}

void MachineViews::Render(std::size_t panel, double time, RenderedView& view) {
  SetPose(RunOf(panel), time, *data_);
  if (ghost_) {
    SetPose(0, time, *ghost_data_);
    scene_.Render(*data_, *ghost_data_, *ghost_, view.picture);
  } else {
    scene_.Render(*data_, view.picture);
  }
  view.projection = scene_.projection();
}

}  // namespace mjdiag
