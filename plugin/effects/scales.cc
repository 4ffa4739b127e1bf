#include "mjdiag/plugin/effects/scales.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kUnknown = std::numeric_limits<double>::infinity();

double BaseUnit(const Scales& scales, std::string_view symbol) {
  if (symbol == "1") return 1.0;
  if (symbol == "N") return scales.force;
  if (symbol == "m" || symbol == "rad") return scales.stroke;
  if (symbol == "s") return scales.stroke / scales.speed;
  if (symbol == "kg") return scales.mass;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Of "m^2".
double PowerOfUnit(const Scales& scales, std::string_view text) {
  const std::size_t caret = std::min(text.find('^'), text.size());
  int power = 1;
  if (caret < text.size()) {
    std::from_chars(text.data() + caret + 1, text.data() + text.size(), power);
  }
  return std::pow(BaseUnit(scales, text.substr(0, caret)), power);
}

}  // namespace

Scales ScalesOf(const SiteMotion& at) {
  const auto largest = [&](Index joint) {
    const Site site{{}, joint, at.site.channel};
    return SiteMotion{at.plant, at.model, at.motion, site}
        .motor()
        .cwiseAbs()
        .maxCoeff();
  };
  Scales scales;
  const VectorXd q = at.q();
  scales.stroke = q.maxCoeff() - q.minCoeff();
  scales.speed = at.v().cwiseAbs().maxCoeff();
  scales.force = largest(at.site.joint);
  if (scales.force == 0.0) {
    for (Index joint = 0; joint < at.model.M.rows(); ++joint) {
      scales.force = std::max(scales.force, largest(joint));
    }
  }
  const int joint = at.plant.dof_jntid[at.site.joint];
  const int address = at.plant.jnt_qposadr[joint];
  scales.stiffness = at.plant.jnt_stiffness[joint];
  const double rest = at.plant.qpos_spring[address] - at.plant.qpos0[address];
  scales.strain = (q.array() - rest).abs().maxCoeff();
  scales.damping = at.plant.dof_damping[at.site.joint];
  scales.mass = at.model.M(at.site.joint, at.site.joint);
  scales.duration = at.motion.time.maxCoeff();
  return scales;
}

double MachineUnit(const Scales& scales, std::string_view unit) {
  double size = 1.0;
  bool below = false;
  while (!unit.empty()) {
    const std::size_t end = std::min(unit.find_first_of(" /"), unit.size());
    const double one = PowerOfUnit(scales, unit.substr(0, end));
    size = below ? size / one : size * one;
    if (end < unit.size()) below |= unit[end] == '/';
    unit.remove_prefix(std::min(end + 1, unit.size()));
  }
  return size > 0.0 && std::isfinite(size) ? size : kUnknown;
}

}  // namespace mjdiag
