#include "mjdiag/plugin/plant/transition.h"

#include <Eigen/Core>
#include <algorithm>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

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

/// Differences of a millionth see what a solver leaves.
ModelPtr WithExactConstraints(const mjModel& model) {
  ModelPtr exact = CopyModel(model);
  exact->opt.disableflags |= mjDSBL_FRICTIONLOSS;
  exact->opt.solver = mjSOL_NEWTON;
  exact->opt.tolerance = std::min(exact->opt.tolerance, 1e-15);
  exact->opt.iterations = std::max(exact->opt.iterations, 200);
  return exact;
}

constexpr double kPerturbation = 1e-6;

/// What sensors read at once of the controls: that of mjd_transitionFD has the wrong sign.
MatrixXd Feedthrough(const mjModel& model, mjData& data) {
  const auto read = [&](int actuator, double by) -> Eigen::VectorXd {
    const double control = data.ctrl[actuator];
    data.ctrl[actuator] = control + by;
    mj_forward(&model, &data);
    data.ctrl[actuator] = control;
    return Eigen::VectorXd::Map(data.sensordata, model.nsensordata);
  };
  MatrixXd D(model.nsensordata, model.nu);
  for (int actuator = 0; actuator < model.nu; ++actuator) {
    double up = kPerturbation;
    double down = kPerturbation;
    if (model.actuator_ctrllimited[actuator] != 0) {
      // At the end of its range to the inside, as mjd_transitionFD does.
      const mjtNum* range = RowOf(model.actuator_ctrlrange, 2, actuator);
      if (data.ctrl[actuator] + up > range[1]) up = 0.0;
      if (data.ctrl[actuator] - down < range[0]) down = 0.0;
    }
    const Eigen::VectorXd difference = read(actuator, up) - read(actuator, -down);
    D.col(actuator) = up + down > 0.0 ? (difference / (up + down)).eval()
                                      : Eigen::VectorXd::Zero(difference.size()).eval();
  }
  mj_forward(&model, &data);
  return D;
}

/// One physics step, all actuators and all sensor data of the model.
StateSpace StepByFiniteDifferences(const mjModel& model, mjData& data) {
  const Eigen::Index states = 2 * model.nv + model.na;
  RowMajor A(states, states), B(states, model.nu), C(model.nsensordata, states);
  // The third matrix is C, whatever the comments in MuJoCo's header say.
  mjd_transitionFD(&model, &data, kPerturbation, 1, A.data(), B.data(), C.data(),
                   nullptr);
  return {A, B, C, Feedthrough(model, data), model.opt.timestep};
}

StateSpace OfChannels(const StateSpace& all, const std::vector<int>& sensors,
                      const std::vector<int>& actuators) {
  return {all.A, all.B(Eigen::all, actuators), all.C(sensors, Eigen::all),
          all.D(sensors, actuators), all.sample_time};
}

}  // namespace

Transition TransitionAbout(const mjModel& model, const Channels& channels,
                           const OperatingPoint& point, int substeps) {
  const ModelPtr exact = WithExactConstraints(model);
  const DataPtr data = MakeData(*exact);
  Set(*exact, point, *data);
  const std::vector<int> sensors = SensorAddresses(channels, model);
  const std::vector<int> actuators = ActuatorAddresses(channels, model);
  const WithoutControlCallback guard;
  const bool moves = !point.velocity.isZero(0.0) || !point.acceleration.isZero(0.0);
  const auto here = [&] {
    return OfChannels(StepByFiniteDifferences(*exact, *data), sensors, actuators);
  };
  Transition transition;
  transition.step = here();
  transition.tick = transition.step;
  StateSpace step = transition.step;
  for (int i = 1; i < substeps; ++i) {
    if (moves) {
      mj_step(exact.get(), data.get());
      step = here();
    }
    transition.tick.A = (step.A * transition.tick.A).eval();
    transition.tick.B = (step.A * transition.tick.B + step.B).eval();
  }
  transition.tick.sample_time = transition.step.sample_time * substeps;
  return transition;
}

std::vector<std::string> StateNames(const mjModel& model) {
  const std::vector<std::string> coordinates = CoordinateNames(model);
  std::vector<std::string> names = coordinates;
  for (const std::string& name : coordinates) names.push_back(name + "'");
  for (auto actuator = static_cast<int>(model.nu - model.na); actuator < model.nu;
       ++actuator) {
    names.push_back(ElementName(model, mjOBJ_ACTUATOR, actuator) + ".act");
  }
  return names;
}

}  // namespace mjdiag
