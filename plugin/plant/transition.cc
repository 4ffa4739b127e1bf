#include "mjdiag/plugin/plant/transition.h"

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The callback runs inside mjd_transitionFD, where it would overwrite the controls
/// that are being varied.
class WithoutControlCallback {
 public:
  WithoutControlCallback() : callback_(mjcb_control) { mjcb_control = nullptr; }
  ~WithoutControlCallback() { mjcb_control = callback_; }
  WithoutControlCallback(const WithoutControlCallback&) = delete;
  WithoutControlCallback& operator=(const WithoutControlCallback&) = delete;

 private:
  mjfGeneric callback_;
};

/// One physics step, all actuators and all sensor data of the model.
StateSpace StepByFiniteDifferences(const mjModel& model) {
  constexpr double kPerturbation = 1e-6;
  const DataPtr data = MakeData(model);
  const Eigen::VectorXd rest = StaticEquilibrium(model);
  Eigen::VectorXd::Map(data->qpos, rest.size()) = rest;
  const Eigen::Index states = 2 * model.nv + model.na;
  RowMajor A(states, states), B(states, model.nu), C(model.nsensordata, states);
  const WithoutControlCallback guard;
  // The third matrix is C, whatever the comments in MuJoCo's header say.
  mjd_transitionFD(&model, data.get(), kPerturbation, 1, A.data(), B.data(), C.data(),
                   nullptr);
  StateSpace step;
  step.A = A;
  step.B = B;
  step.C = C;
  step.D = Eigen::MatrixXd::Zero(model.nsensordata, model.nu);
  step.sample_time = model.opt.timestep;
  return step;
}

}  // namespace

StateSpace TickByFiniteDifferences(const mjModel& model, const Channels& channels,
                                   int substeps) {
  if (model.na > 0) {
    throw InputError("plant", "has actuators with a state", "dyntype \"none\"");
  }
  const ModelPtr frictionless = CopyModel(model);
  frictionless->opt.disableflags |= mjDSBL_FRICTIONLOSS;
  const StateSpace step = StepByFiniteDifferences(*frictionless);
  const std::vector<int> sensors = SensorAddresses(channels, model);
  const std::vector<int> actuators = ActuatorAddresses(channels, model);
  const Eigen::MatrixXd input = step.B(Eigen::all, actuators);
  StateSpace tick;
  tick.A = step.A;
  tick.B = input;
  for (int i = 1; i < substeps; ++i) {
    tick.A = step.A * tick.A;
    tick.B = step.A * tick.B + input;
  }
  tick.C = step.C(sensors, Eigen::all);
  tick.D = Eigen::MatrixXd::Zero(tick.C.rows(), tick.B.cols());
  tick.sample_time = step.sample_time * substeps;
  return tick;
}

}  // namespace mjdiag
