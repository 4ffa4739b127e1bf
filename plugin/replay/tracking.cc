#include "mjdiag/plugin/replay/tracking.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/plugin/setup/measured_channel.h"
#include "mjdiag/signals/bridging.h"
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

/// Called before every record, after every physics step and every tick. With any of them
/// records are followed one after the other.
struct Watch {
  std::function<void()> record;
  std::function<void(const mjModel&, const mjData&, std::span<const int> off)> step;
  /// Which sensors were measured, and count; empty: all.
  std::function<void(const SampleMask& measured, const SampleMask& counted)> tick;
};

/// By how much less innovations pull than they read, of every sensor: one that reads
/// everything twice as large shows twice of what the state is off by.
VectorXd PullOf(const Machine& machine) {
  const std::vector<SensorSetup>& sensors = machine.channels().sensors;
  constexpr double kLeast = 0.1;
  VectorXd pull = VectorXd::Ones(static_cast<Index>(sensors.size()));
  for (const PlacedEffect& effect : machine.effects()) {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      if (sensors[i].element != effect.site) continue;
      pull[static_cast<Index>(i)] /=
          std::max(effect.effect->ReadingScale(effect.values), kLeast);
    }
  }
  return pull;
}

/// One record of a run, beside the machine with all that is put into it.
class RecordFollower {
 public:
  /// @param first   its first sample there
  RecordFollower(const Machine& machine, const MeasuredRun& record,
                 const Observer& observer, Index first)
      : record_(record),
        first_(first),
        L_(observer.L * PullOf(machine).asDiagonal()),
        plant_(StartPlant(machine, record.records.front().readings)),
        stepper_(machine),
        control_(machine, record) {
    ChooseSolver(*plant_.model);
  }

  /// Into its columns of the track.
  void Follow(const Watch& watch, InnovationSequence& track);

 private:
  const MeasuredRun& record_;
  Index first_;
  Eigen::MatrixXd L_;
  StartedPlant plant_;
  Stepper stepper_;
  RecordedInputs control_;
};

void RecordFollower::Follow(const Watch& watch, InnovationSequence& track) {
  const Index first = first_;
  mjModel& model = *plant_.model;
  mjData& data = *plant_.data;
  std::function<void()> after_step;
  if (watch.step) after_step = [&] { watch.step(model, data, stepper_.off()); };
  const Index nv = model.nv;
  Eigen::Map<VectorXd> q(data.qpos, nv);
  Eigen::Map<VectorXd> v(data.qvel, nv);
  VectorXd correction(2 * nv);
  SampleMask measured;
  SampleMask counted;
  const Eigen::ArrayXX<bool>& counts = record_.Counted();
  for (Index k = 0; k < record_.samples(); ++k) {
    if (track.position.size() > 0) {
      track.position.col(first + k) = q;
      track.velocity.col(first + k) = v;
    }
    stepper_.Advance(model, data, control_, after_step);
    if (track.position.size() > 0) {
      track.acceleration.col(first + k) =
          (v - track.velocity.col(first + k)) / record_.sample_time;
    }
    auto innovation = track.innovations.col(first + k);
    innovation = record_.outputs.col(k) -
                 VectorXd::Map(stepper_.outputs().data(), record_.outputs.rows());
    if (record_.measured.size() > 0) {
      measured = record_.measured.col(k);
      innovation = measured.select(innovation, 0.0);
    }
    if (HasDiverged(data)) {
      throw NumericalError(
          "replay: diverged at " +
          std::to_string(static_cast<double>(k) * record_.sample_time) + " s");
    }
    if (counts.size() > 0) counted = counts.col(k);
    if (watch.tick) watch.tick(measured, counted);
    correction.noalias() = L_ * innovation;
    q += correction.head(nv);
    v += correction.tail(nv);
    if (counts.size() > 0) innovation = counted.select(innovation, 0.0);
  }
}

InnovationSequence Follow(const Machine& nominal, const Changes& changes,
                          const MeasuredRun& run, const Observer& observer, bool states,
                          const Watch& watch) {
  const Machine machine = nominal.With(changes);
  InnovationSequence track;
  track.innovations.resize(run.outputs.rows(), run.samples());
  if (states) {
    track.position.resize(machine.plant().nv, run.samples());
    track.velocity.resize(machine.plant().nv, run.samples());
    track.acceleration.resize(machine.plant().nv, run.samples());
  }
  const auto follow = [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    if (watch.record) watch.record();
    const MeasuredRun record = Part(run, i, run.SamplesOf(i));
    const Machine during = DuringRecord(run.records[i], machine);
    RecordFollower(during, record, observer, run.records[i].sample)
        .Follow(watch, track);
  };
  const auto records = static_cast<int>(run.records.size());
  if (watch.record) {
    for (int i = 0; i < records; ++i) follow(i);
  } else {
    ParallelFor(records, follow);
  }
  return track;
}

}  // namespace

Machine DuringRecord(const RecordStart& record, const Machine& machine) {
  return record.machine ? record.machine->ChangedAs(machine) : machine;
}

std::vector<Machine> DuringRecord(const RecordStart& record,
                                  const std::vector<Machine>& machines) {
  std::vector<Machine> during;
  for (const Machine& machine : machines) {
    during.push_back(DuringRecord(record, machine));
  }
  return during;
}

void ChooseSolver(mjModel& model) {
  const bool limited = std::any_of(model.jnt_limited, model.jnt_limited + model.njnt,
                                   [](mjtByte is) { return is != 0; }) ||
                       model.ntendon > 0;
  const bool contacts =
      model.ngeom > 0 && (model.opt.disableflags & mjDSBL_CONTACT) == 0;
  if (model.neq == 0 && !limited && !contacts) model.opt.solver = mjSOL_PGS;
}

Index MeasuredRun::SamplesOf(std::size_t record) const {
  const Index end =
      record + 1 < records.size() ? records[record + 1].sample : samples();
  return end - records[record].sample;
}

std::size_t MeasuredRun::RecordOf(Index sample) const {
  const auto next = std::ranges::upper_bound(records, sample, {}, &RecordStart::sample);
  return static_cast<std::size_t>(next - records.begin() - 1);
}

Index MeasuredRun::TickOf(Index sample) const {
  const RecordStart& record = records[RecordOf(sample)];
  return record.ticks_before + sample - record.sample;
}

void MeasuredRun::Discount(Index samples) {
  if (driven.size() == 0) return;
  counted = measured;
  if (counted.size() == 0) counted.setConstant(outputs.rows(), outputs.cols(), true);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Index end = records[i].sample + SamplesOf(i);
    Index until = records[i].sample;  // where what counts begins again
    for (Index k = records[i].sample; k < end; ++k) {
      if (!driven[k]) until = std::min(end, k + 1 + samples);
      if (k < until) counted.col(k) = false;
    }
  }
}

SampleMask MeasuredRun::CountedOf(Index sensor, Index first, Index count) const {
  if (Counted().size() == 0) return SampleMask::Constant(count, true);
  return Counted().row(sensor).segment(first, count).transpose();
}

VectorXd MeasuredRun::ReadingsOf(Index sensor) const {
  const VectorXd all = outputs.row(sensor);
  if (measured.size() == 0) return all;
  return Kept(all, measured.row(sensor).transpose());
}

Index MeasuredRun::PeriodOf(Index sensor) const {
  if (measured.size() == 0) return 1;
  std::vector<Index> intervals;
  Index last = -1;
  for (Index k = 0; k < samples(); ++k) {
    if (!measured(sensor, k)) continue;
    if (last >= 0) intervals.push_back(k - last);
    last = k;
  }
  if (intervals.empty()) return 1;
  const auto middle = intervals.begin() + std::ssize(intervals) / 2;
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

VectorXd MeasuredRun::Time() const {
  VectorXd time(samples());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Index n = SamplesOf(i);
    time.segment(records[i].sample, n) =
        sample_time * VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1));
  }
  return time;
}

MeasuredRun Excerpt(const MeasuredRun& run, Index first, Index samples) {
  MeasuredRun part;
  part.sample_time = run.sample_time;
  part.outputs = run.outputs.middleCols(first, samples);
  part.inputs = run.inputs.middleCols(first, samples);
  if (run.finer_inputs.size() > 0) {
    part.finer_inputs =
        run.finer_inputs.middleCols(first * run.ticks(), samples * run.ticks());
  }
  if (run.on.size() > 0) part.on = run.on.middleCols(first, samples);
  if (run.measured.size() > 0) part.measured = run.measured.middleCols(first, samples);
  if (run.counted.size() > 0) part.counted = run.counted.middleCols(first, samples);
  if (run.driven.size() > 0) part.driven = run.driven.segment(first, samples);
  const RecordStart& record = run.records[run.RecordOf(first)];
  part.records = {{0, {}, record.machine, run.TickOf(first)}};
  return part;
}

MeasuredRun Part(const MeasuredRun& run, std::size_t record, Index samples) {
  const Index first = run.records[record].sample;
  MeasuredRun part = Excerpt(run, first, samples);
  part.records.clear();
  for (const RecordStart& start : run.records) {
    if (start.sample < first || start.sample >= first + samples) continue;
    part.records.push_back(start);
    part.records.back().sample -= first;
  }
  return part;
}

MeasuredRun Joined(const std::vector<MeasuredRun>& runs) {
  MeasuredRun all;
  all.sample_time = runs.front().sample_time;
  all.records.clear();
  Index samples = 0;
  for (const MeasuredRun& run : runs) samples += run.samples();
  const auto size = [samples](const Eigen::MatrixXd& one) {
    return one.size() > 0 ? Eigen::MatrixXd(one.rows(), samples) : Eigen::MatrixXd();
  };
  all.outputs = size(runs.front().outputs);
  all.inputs = size(runs.front().inputs);
  all.on = size(runs.front().on);
  const Index ticks = runs.front().ticks();
  if (ticks > 1) all.finer_inputs.resize(all.inputs.rows(), ticks * samples);
  const bool complete = std::ranges::all_of(
      runs, [](const MeasuredRun& run) { return run.measured.size() == 0; });
  if (!complete) all.measured.setConstant(all.outputs.rows(), samples, true);
  const bool all_driven = std::ranges::all_of(
      runs, [](const MeasuredRun& run) { return run.driven.size() == 0; });
  if (!all_driven) all.driven.setConstant(samples, true);
  Index first = 0;
  for (const MeasuredRun& run : runs) {
    all.outputs.middleCols(first, run.samples()) = run.outputs;
    all.inputs.middleCols(first, run.samples()) = run.inputs;
    if (ticks > 1) {
      all.finer_inputs.middleCols(first * ticks, run.samples() * ticks) =
          run.finer_inputs;
    }
    if (run.on.size() > 0) all.on.middleCols(first, run.samples()) = run.on;
    if (run.measured.size() > 0) {
      all.measured.middleCols(first, run.samples()) = run.measured;
    }
    if (run.driven.size() > 0) all.driven.segment(first, run.samples()) = run.driven;
    for (const RecordStart& start : run.records) {
      all.records.push_back(start);
      all.records.back().sample += first;
    }
    first += run.samples();
  }
  return all;
}

MeasuredRun ToMeasuredRun(const Setup& setup, const Record& measured) {
  MeasuredRun run;
  run.sample_time = setup.rates.tick();
  run.records.front().readings = Replay(setup, measured).start;
  run.outputs = MeasuredBy(setup.channels.sensors, measured);
  run.measured = MeasuredOf(measured, ChannelsOf(setup.channels.sensors));
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    const SampleMask& known = measured.At(actuator.channel).measured;
    if (known.size() == 0) continue;
    const SampleMask guessed = InGaps(known);
    if (!guessed.any()) continue;
    if (run.driven.size() == 0) run.driven.setConstant(run.samples(), true);
    run.driven = run.driven && !guessed;
  }
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

InnovationSequence RunPredictor(const Machine& machine, const Changes& changes,
                                const MeasuredRun& run, const Observer& observer,
                                bool states) {
  return Follow(machine, changes, run, observer, states, {});
}

InnovationSequence RunPredictor(const Machine& machine, const Changes& changes,
                                const MeasuredRun& run, const Observer& observer,
                                ErrorDynamics& dynamics) {
  TangentRecorder recorder(machine.plant(), machine.linear());
  const Watch watch{
      [&] { dynamics.Begin(); },
      [&recorder](const mjModel& changed, const mjData& data,
                  std::span<const int> off) { recorder.Substep(changed, data, off); },
      [&](const SampleMask& measured, const SampleMask& counted) {
        dynamics.Add(recorder.EndTick(), measured, counted);
      }};
  return Follow(machine, changes, run, observer, true, watch);
}

Eigen::MatrixXd InputsThatAct(const Machine& machine, const MeasuredRun& run,
                              const Eigen::MatrixXd& position,
                              const Eigen::MatrixXd& velocity) {
  Eigen::MatrixXd inputs = run.inputs;
  if (run.on.size() == 0) return inputs;
  const mjModel& model = machine.plant();
  const DataPtr data = MakeData(model);
  for (Index k = 0; k < run.samples(); ++k) {
    if ((run.on.col(k).array() != 0.0).all()) continue;
    VectorXd::Map(data->qpos, model.nq) = position.col(k);
    VectorXd::Map(data->qvel, model.nv) = velocity.col(k);
    mj_fwdPosition(&model, data.get());
    mj_fwdVelocity(&model, data.get());
    for (Index i = 0; i < inputs.rows(); ++i) {
      const int motor = machine.actuator_addresses()[static_cast<std::size_t>(i)];
      if (run.on(i, k) == 0.0) inputs(i, k) = OpenCircuitCommand(model, *data, motor);
    }
  }
  return inputs;
}

ObservedMotion ObserveMotion(const Machine& machine, const MeasuredRun& run,
                             const InnovationSequence& track) {
  ObservedMotion motion;
  motion.sample_time = run.sample_time;
  const Eigen::Map<const VectorXd> rest(machine.plant().qpos0, machine.plant().nv);
  motion.position = track.position.colwise() - rest;
  motion.velocity = track.velocity;
  motion.own_acceleration = track.acceleration;
  motion.time = run.Time();
  motion.acceleration.resize(track.velocity.rows(), track.velocity.cols());
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const auto of_record = Eigen::seqN(run.records[i].sample, run.SamplesOf(i));
    motion.acceleration(Eigen::all, of_record) =
        CentralDifferences(track.velocity(Eigen::all, of_record), run.sample_time);
  }
  motion.inputs = InputsThatAct(machine, run, track.position, track.velocity);
  motion.outputs = run.outputs;
  return motion;
}

}  // namespace mjdiag
