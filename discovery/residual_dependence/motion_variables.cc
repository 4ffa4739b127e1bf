#include "mjdiag/discovery/residual_dependence/motion_variables.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<MotionVariable> MotionVariables(const Machine& machine,
                                            const ObservedMotion& motion,
                                            const std::vector<std::string>& joints,
                                            Index site, double still,
                                            std::size_t records) {
  const mjModel& plant = machine.plant();
  const std::vector<std::string>& coordinates = machine.mechanics().coordinates;
  std::vector<MotionVariable> variables;
  for (const std::string& name : joints) {
    const Index j = std::ranges::find(coordinates, name) - coordinates.begin();
    const auto of = static_cast<int>(j);
    const bool hinge = plant.jnt_type[plant.dof_jntid[j]] == mjJNT_HINGE;
    const std::string unit = hinge ? "rad" : "m";
    variables.push_back({{name + " position", unit, motion.position.row(j), false},
                         CurveVariable::kPosition,
                         of});
    variables.push_back(
        {{name + " velocity", unit + "/s", motion.velocity.row(j), j == site},
         CurveVariable::kVelocity,
         of,
         CurveFactor::kVelocity});
    variables.push_back(
        {{name + " acceleration", unit + "/s^2", motion.acceleration.row(j), false}});
  }
  const VectorXd own = motion.velocity.row(site);
  const VectorXd direction = own.unaryExpr([still](double v) {
    return std::abs(v) < still ? 0.0 : v > 0.0 ? 1.0 : -1.0;
  });
  MotionVariable sign{{"direction", "1", direction, true}};
  sign.factor = CurveFactor::kDirection;
  variables.push_back(std::move(sign));
  const auto& actuators = machine.channels().actuators;
  for (std::size_t u = 0; u < actuators.size(); ++u) {
    variables.push_back({{actuators[u].channel, actuators[u].unit,
                          motion.inputs.row(static_cast<Index>(u)), false},
                         CurveVariable::kCommand,
                         FindElement(plant, mjOBJ_ACTUATOR, actuators[u].element)});
  }
  // Of several records one after the other, for words only.
  const Index n = motion.samples();
  MotionVariable time{
      {"time", "s",
       VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1) * motion.sample_time),
       false}};
  if (records == 1) time.kind = CurveVariable::kTime;
  variables.push_back(std::move(time));
  return variables;
}

}  // namespace mjdiag
