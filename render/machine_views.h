#pragma once
// The machine as OpenGL draws it: a view of every run, or one view of the last run with
// the first as a ghost.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/render/amplification.h"
#include "mjdiag/render/clip.h"
#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/site_path.h"

namespace mjdiag {

/// What OpenGL has drawn of a panel.
struct RenderedView {
  Image picture;  ///< at least as large as the panel's view
  Projection projection;
};

class MachineViews {
 public:
  /// Model and records must outlive the views. InputError as RenderClip.
  MachineViews(const mjModel& model, std::span<const Record* const> records,
               TimeRange range, const PictureOptions& options,
               const ClipLayout& layout);

  const Amplification& amplification() const { return *amplification_; }
  /// The run that a panel shows.
  std::size_t RunOf(std::size_t panel) const;
  /// Where one run is drawn into the view of another.
  const std::optional<Ghost>& ghost() const { return ghost_; }
  /// Whose paths these are.
  const std::string& path_site() const { return path_site_; }
  /// Of every run; empty without a site.
  const std::vector<SitePath>& paths() const { return paths_; }

  /// The panel at `time` [s]; `view` keeps its memory.
  void Render(std::size_t panel, double time, RenderedView& view);

 private:
  double ViewHeightAtStart();
  Ghost FindGhost(double view_height);
  void SetPose(std::size_t run, double time, mjData& data) const;

  const mjModel& model_;
  std::span<const Record* const> records_;
  TimeRange range_;
  SceneRenderer scene_;
  DataPtr data_;
  DataPtr ghost_data_;
  std::optional<Amplification> amplification_;
  std::optional<Ghost> ghost_;
  std::string path_site_;
  std::vector<SitePath> paths_;
};

}  // namespace mjdiag
