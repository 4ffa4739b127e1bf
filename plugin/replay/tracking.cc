#include "mjdiag/plugin/replay/tracking.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "mjdiag/plugin/effects/trial_signals.h"
#include "mjdiag/plugin/machine/input_course.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/plugin/setup/measured_channel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Samples of sensors or actuators, in the units that the setup gives them.
template <typename Element>
Eigen::MatrixXd MeasuredBy(const std::vector<Element>& elements,
                           const Record& measured) {
  for (const Element& element : elements) {
    MeasuredChannel(measured, element.channel, element.unit);
  }
  return SamplesOf(measured, ChannelsOf(elements));
}

/// Gives what was recorded, and keeps what the machine reads.
class RecordedInputs final : public TickControl {
 public:
  RecordedInputs(const Machine& machine, const MeasuredRun& run)
      : run_(run), reading_(run.outputs.rows()) {
    Index i = 0;
    for (const ActuatorSetup& actuator : machine.channels().actuators) {
      courses_.emplace_back(actuator.hold, run.inputs.row(i++).transpose(),
                            machine.rates().substeps);
    }
  }

  void Tick(std::span<const double> outputs,
            std::span<double> inputs) noexcept override {
    std::copy(outputs.begin(), outputs.end(), reading_.begin());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      inputs[i] = run_.inputs(static_cast<Index>(i), tick_);
    }
    ++tick_;
  }
  double Above(std::size_t actuator, int substep) const noexcept override {
    return courses_[actuator].Above(tick_ - 1, substep);
  }
  bool IsOn(std::size_t actuator) const noexcept override {
    return run_.on.size() == 0 ||
           run_.on(static_cast<Index>(actuator), tick_ - 1) != 0.0;
  }
  const VectorXd& reading() const { return reading_; }

 private:
  const MeasuredRun& run_;
  VectorXd reading_;
  std::vector<InputCourse> courses_;
  Index tick_ = 0;
};

/// Called after every physics step and every tick.
struct Watch {
  std::function<void(const mjModel&, const mjData&, std::span<const int> off)> step;
  std::function<void()> tick;
};

Track Follow(const Machine& nominal, const Changes& changes, const MeasuredRun& run,
             const Observer& observer, bool states, const Watch& watch) {
  const Machine machine = nominal.With(changes);
  const StartedPlant plant = StartPlant(machine, run.start);
  mjModel& model = *plant.model;
  mjData& data = *plant.data;
  ChooseSolver(model);
  Stepper stepper(machine);
  RecordedInputs control(machine, run);
  std::function<void()> after_step;
  if (watch.step) after_step = [&] { watch.step(model, data, stepper.off()); };

  const Index n = run.samples();
  const Index nv = model.nv;
  Track track;
  track.innovations.resize(run.outputs.rows(), n);
  if (states) {
    track.position.resize(nv, n);
    track.velocity.resize(nv, n);
  }
  Eigen::Map<VectorXd> q(data.qpos, nv);
  Eigen::Map<VectorXd> v(data.qvel, nv);
  VectorXd correction(2 * nv);
  for (Index k = 0; k < n; ++k) {
    if (states) {
      track.position.col(k) = q;
      track.velocity.col(k) = v;
    }
    stepper.Advance(model, data, control, after_step);
    track.innovations.col(k) = run.outputs.col(k) - control.reading();
    if (HasDiverged(data)) {
      throw NumericalError("replay: diverged at " +
                           std::to_string(static_cast<double>(k) * run.sample_time) +
                           " s");
    }
    if (watch.tick) watch.tick();
    correction.noalias() = observer.L * track.innovations.col(k);
    q += correction.head(nv);
    v += correction.tail(nv);
  }
  return track;
}

/// Puts in what the ends of open circuits show.
void OpenCircuits(const Machine& machine, const MeasuredRun& run, const Track& track,
                  Eigen::MatrixXd& inputs) {
  const mjModel& model = machine.plant();
  const DataPtr data = MakeData(model);
  for (Index k = 0; k < run.samples(); ++k) {
    if ((run.on.col(k).array() != 0.0).all()) continue;
    VectorXd::Map(data->qpos, model.nq) = track.position.col(k);
    VectorXd::Map(data->qvel, model.nv) = track.velocity.col(k);
    mj_fwdPosition(&model, data.get());
    mj_fwdVelocity(&model, data.get());
    for (Index i = 0; i < inputs.rows(); ++i) {
      const int motor = machine.actuator_addresses()[static_cast<std::size_t>(i)];
      if (run.on(i, k) == 0.0) inputs(i, k) = OpenCircuitCommand(model, *data, motor);
    }
  }
}

}  // namespace

void ChooseSolver(mjModel& model) {
  const bool limited = std::any_of(model.jnt_limited, model.jnt_limited + model.njnt,
                                   [](mjtByte is) { return is != 0; }) ||
                       model.ntendon > 0;
  const bool contacts =
      model.ngeom > 0 && (model.opt.disableflags & mjDSBL_CONTACT) == 0;
  if (model.neq == 0 && !limited && !contacts) model.opt.solver = mjSOL_PGS;
}

MeasuredRun ToMeasuredRun(const Setup& setup, const Record& measured) {
  MeasuredRun run;
  run.sample_time = setup.rates.tick();
  run.start = Replay(setup, measured).start;
  run.outputs = MeasuredBy(setup.channels.sensors, measured);
  run.inputs = MeasuredBy(setup.channels.actuators, measured);
  if (!setup.channels.Switches().empty()) {
    run.on = Eigen::MatrixXd::Ones(run.inputs.rows(), run.samples());
    Index i = 0;
    for (const ActuatorSetup& actuator : setup.channels.actuators) {
      const Channel* known = measured.Find(actuator.enabled_by);
      if (known != nullptr) run.on.row(i) = known->samples.transpose();
      ++i;
    }
  }
  return run;
}

Track FollowRun(const Machine& machine, const Changes& changes, const MeasuredRun& run,
                const Observer& observer, bool states) {
  return Follow(machine, changes, run, observer, states, {});
}

Track FollowRun(const Machine& machine, const Changes& changes, const MeasuredRun& run,
                const Observer& observer, ErrorDynamics& dynamics) {
  TangentRecorder recorder(machine.plant(), machine.linear());
  const Watch watch{
      [&recorder](const mjModel& changed, const mjData& data,
                  std::span<const int> off) { recorder.Substep(changed, data, off); },
      [&] { dynamics.Add(recorder.EndTick()); }};
  return Follow(machine, changes, run, observer, true, watch);
}

ObservedMotion ObserveMotion(const Machine& machine, const MeasuredRun& run,
                             const Track& track) {
  ObservedMotion motion;
  motion.sample_time = run.sample_time;
  const Eigen::Map<const VectorXd> rest(machine.plant().qpos0, machine.plant().nv);
  motion.position = track.position.colwise() - rest;
  motion.velocity = track.velocity;
  motion.acceleration = CentralDifferences(track.velocity, run.sample_time);
  motion.inputs = run.inputs;
  if (run.on.size() > 0) OpenCircuits(machine, run, track, motion.inputs);
  motion.outputs = run.outputs;
  return motion;
}

}  // namespace mjdiag
