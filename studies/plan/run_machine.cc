#include "mjdiag/studies/plan/run_machine.h"

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

/// Whether another value of that key makes another plant.
bool MovesThePlant(const std::string& key) {
  for (const char* part : {"plant", "physics", "rates", "calibration"}) {
    if (key.starts_with(part)) return true;
  }
  return false;
}

/// Its beginning, of that duration.
Record Cut(Record record, double duration) {
  if (!(duration > 0.0)) return record;
  const auto wanted =
      static_cast<Eigen::Index>(std::max(1.0, duration / record.sample_time() + 0.5));
  return record.Slice(0, std::min(wanted, record.samples()));
}

/// The effects of a run, each with all of its parameters that vary.
std::vector<PlacedEffect> PlacedIn(const PlannedRun& run) {
  std::vector<std::pair<std::string, std::string>> texts;  // by effect and site
  for (const DrawnAxis& drawn : run.axes) {
    if (drawn.axis->kind != AxisKind::kEffect || !drawn.present()) continue;
    const std::string& effect = drawn.axis->effect;
    const std::string at = effect.substr(0, effect.find(':'));
    auto found =
        std::ranges::find(texts, at, &std::pair<std::string, std::string>::first);
    if (found == texts.end()) found = texts.insert(texts.end(), {at, effect});
    std::string& text = found->second;
    text += text.find(':') == text.npos ? ":" : ",";
    text += drawn.axis->parameter + "=" + AllDigits(drawn.value);
  }
  std::vector<PlacedEffect> effects;
  for (const auto& [at, text] : texts) effects.push_back(ParseEffect(text));
  return effects;
}

}  // namespace

Machine MachineWithKeys(const StudyPlan& plan, const Machine& machine,
                        const std::vector<std::pair<std::string, double>>& keys) {
  std::vector<std::string> overrides = plan.overrides;
  bool other_plant = false;
  for (const auto& [key, value] : keys) {
    overrides.push_back(key + "=" + AllDigits(value));
    other_plant = other_plant || MovesThePlant(key);
  }
  Setup setup = ReadSetup(plan.setup, overrides);
  return other_plant ? Machine(std::move(setup)) : machine.WithSetup(std::move(setup));
}

RunMaker::RunMaker(const LoadedPlan& loaded) : loaded_(loaded) {
  const StudyPlan& plan = loaded.plan;
  const Setup& setup = loaded.machine.setup();
  for (const PlanMotion& motion : plan.motions) {
    records_.push_back(
        motion.record.empty()
            ? Record()
            : Cut(ReadMeasured(setup, motion.record).record, plan.duration));
    motions_.push_back(MotionOf(setup, motions_.size()));
    longest_ = std::max(longest_, motions_.back().samples());
  }
}

Excitation RunMaker::MotionOf(const Setup& setup, std::size_t motion) const {
  const PlanMotion& wanted = loaded_.plan.motions[motion];
  if (!wanted.record.empty()) return Replay(setup, records_[motion]);
  Trajectory trajectory = setup.trajectories.Find(wanted.name);
  if (loaded_.plan.duration > 0.0) trajectory.duration = loaded_.plan.duration;
  return FollowTrajectory(setup, trajectory);
}

ReadyRun RunMaker::Make(const PlannedRun& run) const {
  const StudyPlan& plan = loaded_.plan;
  std::vector<std::pair<std::string, double>> keys;
  RunOptions options;
  options.mode = plan.mode;
  options.seed = run.seed;
  options.linear_part = plan.linear;
  Changes changes;
  changes.numbers = run.numbers;
  changes.effects = PlacedIn(run);
  for (const DrawnAxis& drawn : run.axes) {
    const std::string& name = drawn.axis->name;
    if (!drawn.varies) continue;
    switch (drawn.axis->kind) {
      case AxisKind::kKey:
        keys.emplace_back(name, drawn.value);
        break;
      case AxisKind::kNoise:
        options.noise_scale = drawn.value;
        break;
      case AxisKind::kEffect:
        break;  // above
      default:
        if (!drawn.present()) break;
        if (drawn.axis->appears) {
          options.late_faults.push_back(
              {{name, drawn.value}, drawn.time, drawn.axis->growth});
        } else if (drawn.axis->kind == AxisKind::kDisturbance) {
          options.disturbances[name] = drawn.value;
        } else {
          changes.faults.push_back({name, drawn.value});
        }
    }
  }
  const Machine based =
      keys.empty() ? loaded_.machine : MachineWithKeys(plan, loaded_.machine, keys);
  const auto number = static_cast<std::size_t>(run.motion);
  Excitation motion = keys.empty() ? motions_[number] : MotionOf(based.setup(), number);
  return {based.With(changes), std::move(motion), std::move(options)};
}

Record RunMaker::Simulate(const ReadyRun& ready) const {
  RunOptions options = ready.options;
  options.log_joints = !loaded_.plan.keep.joints.empty();
  return loaded_.plan.linear ? SimulateLinear(ready.machine, ready.motion, options)
                             : mjdiag::Simulate(ready.machine, ready.motion, options);
}

Record RunMaker::Simulate(const PlannedRun& run) const { return Simulate(Make(run)); }

}  // namespace mjdiag
