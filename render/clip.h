#pragma once
// Clips and stills: runs of one machine side by side in slow motion, their small motion
// amplified (amplification.h), with time, tracking errors and strip charts in step, and
// what a diagnosis said at the time (diagnosis_overlay.h).
//
// Frame n shows time t_n = begin + n * speed / fps. OpenGL renders the next picture
// while the last is painted and encoded; the frames are the same bytes every time.

#include <mujoco/mujoco.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/render/diagnosis_overlay.h"
#include "mjdiag/render/scene/scene_renderer.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// One run, drawn in a panel of its own. The first run is the reference (the healthy
/// one) that driven joints of the others are compared with.
struct ClipRun {
  std::string title;
  const Record* record = nullptr;  ///< not owned; has "joint.<name>" of every joint
};

/// By how much the motion of every joint was enlarged, by its name.
using JointFactors = std::map<std::string, double>;

/// What a picture shows.
struct PictureOptions {
  int width = 1280;         ///< [px], even
  int height = 720;         ///< [px], even
  std::string camera = {};  ///< MJCF camera; empty: a free camera
  Smoothing smoothing = Smoothing::kNone;
  bool shadows = false;
  /// Axes whose tracking error "a_ref" - "a" is shown. Empty: all that the first record
  /// has, as many as fit.
  std::vector<std::string> axes;
  /// Joint -> amplification factor; the others' follow from the data.
  JointFactors amplify;
  std::optional<double> amplify_all;  ///< one factor for all joints without an own one
  std::optional<double> begin;        ///< [s]; default: where all records have begun
  std::optional<double> end;          ///< [s]; default: where the first record ends
  /// One view: the last run, and the first as a translucent ghost where it differs.
  bool ghost = false;
  /// Site whose path is drawn. Empty: the tool's (site_path.h); "none": no path.
  std::string path_site = {};
  std::optional<DiagnosisOverlay> diagnosis = {};  ///< of one of the runs
};

struct ClipOptions {
  PictureOptions picture;
  double fps = 30.0;    ///< frames a second of clip
  double speed = 0.02;  ///< seconds of machine time a second of clip
  /// Folder for the frames as frame_000000.png, ...; empty: none.
  std::filesystem::path frames;
  std::function<void(double fraction)> progress;  ///< called after every frame
};

struct ClipSummary {
  int frames = 0;
  std::string codec;  ///< "avc1" (H.264) or "mp4v"
  JointFactors amplification;
};

/// Finds what is wrong with the options without any run: size, camera, site, or no
/// OpenGL. InputError says what.
void CheckPicture(const mjModel& model, const PictureOptions& options);

/// Writes an mp4. Nothing is left behind on an error. InputError: no runs, a record
/// without a joint's channel, unknown camera, axis or joint, an option out of bounds,
/// times outside of the records, a ghost of other than two runs, no encoder, `file` not
/// writable or not *.mp4.
ClipSummary RenderClip(const mjModel& model, std::span<const ClipRun> runs,
                       const ClipOptions& options, const std::filesystem::path& file);

/// Writes the picture of one moment as PNG; returns the amplification.
JointFactors RenderStill(const mjModel& model, std::span<const ClipRun> runs,
                         const PictureOptions& options, double time,
                         const std::filesystem::path& file);

}  // namespace mjdiag
