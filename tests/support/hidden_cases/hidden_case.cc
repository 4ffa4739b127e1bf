#include "support/hidden_cases/hidden_case.h"

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag::test {

Hidden Nothing(const Machine&, CaseDice&) { return {}; }

Eigen::Index JointOf(const Machine& machine, const std::string& name) {
  return machine.plant().jnt_dofadr[FindElement(machine.plant(), mjOBJ_JOINT, name)];
}

Eigen::Index ActuatorOf(const Machine& machine, const std::string& channel) {
  return machine.channels().ActuatorIndex(channel);
}

Eigen::Index SensorOf(const Machine& machine, const std::string& channel) {
  return machine.channels().SensorIndex(channel);
}

}  // namespace mjdiag::test
