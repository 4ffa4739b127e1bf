#include "mjdiag/render/site_path.h"

#include <algorithm>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// Of a path; more would be closer together than pixels.
constexpr Eigen::Index kMostPoints = 800;

int Depth(const mjModel& model, int body) {
  int depth = 0;
  for (; body > 0; body = model.body_parentid[body]) ++depth;
  return depth;
}

}  // namespace

std::optional<int> ToolSite(const mjModel& model) {
  std::optional<int> tool;
  int deepest = 0;
  for (int site = 0; site < model.nsite; ++site) {
    const int body = model.site_bodyid[site];
    const int depth = Depth(model, body);
    if (model.body_weldid[body] == 0 || depth < deepest) continue;
    deepest = depth;
    tool = site;
  }
  return tool;
}

std::optional<int> PathSite(const mjModel& model, const std::string& name) {
  if (name.empty()) return ToolSite(model);
  if (name == "none") return std::nullopt;
  const int site = mj_name2id(&model, mjOBJ_SITE, name.c_str());
  if (site >= 0) return site;
  std::string names = "none";
  for (int id = 0; id < model.nsite; ++id) {
    names += ", " + ElementName(model, mjOBJ_SITE, id);
  }
  throw InputError("path", "no site named \"" + name + "\"", "one of: " + names);
}

SitePath DrawnPath(const mjModel& model, int site, const Amplification& amplification,
                   const Record& run, TimeRange range, mjData& data) {
  const SampleRange within = SamplesWithin(run, range);
  const Eigen::Index count = std::min(within.count(), kMostPoints);
  SitePath path;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index sample =
        within.first +
        (count > 1 ? i * (within.count() - 1) / (count - 1) : Eigen::Index{0});
    const double time =
        run.start_time() + static_cast<double>(sample) * run.sample_time();
    SetPositions(model, amplification.DrawnPositions(run, time), data);
    mj_kinematics(&model, &data);
    path.times.push_back(time);
    path.positions.emplace_back(
        Eigen::Map<const Eigen::Vector3d>(RowOf(data.site_xpos, 3, site)));
  }
  return path;
}

}  // namespace mjdiag
