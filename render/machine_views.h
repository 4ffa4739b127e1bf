#pragma once
// The machine on a picture: a view of every run, or one view of the last run with the
// first as a ghost; with titles, and the path of a site.

#include <memory>
#include <span>
#include <vector>

#include "mjdiag/plugin/mujoco_model.h"
#include "mjdiag/render/amplification.h"
#include "mjdiag/render/clip.h"
#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/site_path.h"
#include "mjdiag/render/typesetter.h"

namespace mjdiag {

class MachineViews {
 public:
  /// Runs and records must outlive the views. InputError as RenderClip.
  MachineViews(const mjModel& model, std::span<const ClipRun> runs,
               std::span<const Record* const> records, TimeRange range,
               const PictureOptions& options, const ClipLayout& layout);

  const Amplification& amplification() const { return *amplification_; }
  /// The run that a panel shows.
  std::size_t RunOf(std::size_t panel) const;
  /// View, titles and path of the panel as of `time` [s].
  void Draw(std::size_t panel, double time, Typesetter& type, cv::Mat& picture);

 private:
  double ViewHeightAtStart();
  void FindGhost(double view_height);
  void SetPose(std::size_t run, double time, mjData& data) const;
  void DrawTitle(const cv::Rect& place, std::size_t run, bool is_ghost,
                 Typesetter& type, cv::Mat& picture) const;
  void DrawPath(const cv::Rect& view, std::size_t run, double time,
                cv::Mat& picture) const;
  void DrawLegend(const PanelLayout& panel, std::span<const std::size_t> runs,
                  Typesetter& type, cv::Mat& picture) const;

  const mjModel& model_;
  std::span<const ClipRun> runs_;
  std::span<const Record* const> records_;
  TimeRange range_;
  const ClipLayout& layout_;
  bool has_ghost_;
  SceneRenderer scene_;
  DataPtr data_;
  DataPtr ghost_data_;
  std::optional<Amplification> amplification_;
  Ghost ghost_;
  std::string site_;             // whose paths these are
  std::vector<SitePath> paths_;  // of every run; empty without a site
  Image view_;
};

}  // namespace mjdiag
