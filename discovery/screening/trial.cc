#include "mjdiag/discovery/screening/trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/effects/trial_signals.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// What a generator of trials has in hand.
class TrialMaker {
 public:
  TrialMaker(const mjModel& plant, const MechanicalModel& model,
             const Candidate& candidate, const ObservedMotion& motion)
      : plant_(plant), model_(model), candidate_(candidate), motion_(motion) {}

  std::vector<Trial> Make();

 private:
  using Shape = std::map<std::string, double>;

  VectorXd q() const { return motion_.position.row(candidate_.joint); }
  VectorXd v() const { return motion_.velocity.row(candidate_.joint); }
  VectorXd u() const { return motion_.inputs.row(candidate_.channel); }
  VectorXd y() const { return motion_.outputs.row(candidate_.channel); }
  MatrixXd JointEntry(Index columns) const {
    return VectorXd::Unit(model_.M.rows(), candidate_.joint).replicate(1, columns);
  }
  MatrixXd MotorEntry(Index columns) const {
    return model_.Gamma.col(candidate_.channel).replicate(1, columns);
  }

  /// One amplitude for each named parameter, no shape.
  void AddLinear(const MatrixXd& signals, const MatrixXd& entry,
                 std::vector<std::string> names, double offset = 0.0,
                 bool not_negative = false);
  void AddReading(const VectorXd& signal, const std::string& name, double offset);

  void MakeFriction();
  void MakeSprings();
  void AddOtherSprings(double stiffness, const VectorXd& strain);
  void MakeDrives();
  void MakeStructure();
  void MakeEncoder();
  void MakeKnob();

  const mjModel& plant_;
  const MechanicalModel& model_;
  const Candidate& candidate_;
  const ObservedMotion& motion_;
  std::vector<Trial> trials_;
};

void TrialMaker::AddLinear(const MatrixXd& signals, const MatrixXd& entry,
                           std::vector<std::string> names, double offset,
                           bool not_negative) {
  trials_.push_back({signals, entry,
                     [names, offset, not_negative](const Amplitudes& a) -> Parameters {
                       Shape values;
                       for (std::size_t i = 0; i < names.size(); ++i) {
                         const double value = offset + a[static_cast<Index>(i)];
                         if (not_negative && value < 0.0) return std::nullopt;
                         values[names[i]] = value;
                       }
                       return values;
                     }});
}

void TrialMaker::AddReading(const VectorXd& signal, const std::string& name,
                            double offset) {
  AddLinear(signal, MatrixXd(), {name}, offset);
}

void TrialMaker::MakeFriction() {
  const std::string& effect = candidate_.cause.spec.effect;
  const VectorXd s = Direction(v());
  const double top = v().cwiseAbs().maxCoeff();
  if (effect == "coulomb_friction") {
    AddLinear(-s, JointEntry(1), {"force"}, 0.0, true);
  } else if (effect == "viscous_friction") {
    AddLinear(-v(), JointEntry(1), {"coefficient"});
  } else if (effect == "asymmetric_viscous_friction") {
    MatrixXd sides(v().size(), 2);
    sides << -v().cwiseMax(0.0), -v().cwiseMin(0.0);
    AddLinear(sides, JointEntry(2), {"positive", "negative"});
  } else if (effect == "quadratic_drag") {
    AddLinear(-v().cwiseProduct(v().cwiseAbs()), JointEntry(1), {"coefficient"});
  } else if (effect == "stribeck_friction") {
    for (const double velocity : LogGrid(0.003 * top, 0.6 * top, 7)) {
      MatrixXd parts(v().size(), 2);
      parts.col(0) = -s;
      parts.col(1) = -s.array() * (-(v().array() / velocity).square()).exp();
      trials_.push_back(
          {parts, JointEntry(2), [velocity](const Amplitudes& a) -> Parameters {
             if (a[1] <= 0.0 || a[0] < -0.1 * a[1]) return std::nullopt;
             return Shape{{"coulomb", std::max(a[0], 0.0)},
                          {"breakaway", a[1]},
                          {"velocity", velocity}};
           }});
    }
  } else if (effect == "presliding_hysteresis") {
    for (const double length : LogGrid(1e-4 * Range(q()), 0.5 * Range(q()), 8)) {
      trials_.push_back({-Follow(q(), length) / length, JointEntry(1),
                         [length](const Amplitudes& a) -> Parameters {
                           if (a[0] <= 0.0) return std::nullopt;
                           return Shape{{"force", a[0]}, {"stiffness", a[0] / length}};
                         }});
    }
  } else if (effect == "hysteretic_stiffness") {
    for (const double length : LogGrid(3e-3 * Range(q()), 2.0 * Range(q()), 8)) {
      MatrixXd parts(q().size(), 2);
      parts << -q(), -Follow(q(), length);
      trials_.push_back(
          {parts, JointEntry(2), [length](const Amplitudes& a) -> Parameters {
             if (a[0] <= 0.0 || a[1] <= 0.0) return std::nullopt;
             return Shape{
                 {"stiffness", a[0]}, {"loss", a[1] / a[0]}, {"length", length}};
           }});
    }
  }
}

void TrialMaker::MakeSprings() {
  const std::string& effect = candidate_.cause.spec.effect;
  if (effect == "linear_stiffness") {
    AddLinear(-q(), JointEntry(1), {"stiffness"});
  } else if (effect == "cubic_stiffness") {
    AddLinear(-q().array().cube().matrix(), JointEntry(1), {"coefficient"});
  } else if (effect == "structural_stiffness" || effect == "backlash") {
    const int joint = plant_.dof_jntid[candidate_.joint];
    const int address = plant_.jnt_qposadr[joint];
    const double rest = plant_.qpos_spring[address] - plant_.qpos0[address];
    const double stiffness = plant_.jnt_stiffness[joint];
    const VectorXd strain = q().array() - rest;
    if (effect == "structural_stiffness") {
      AddLinear(-stiffness * strain, JointEntry(1), {"factor"}, 1.0, true);
      AddOtherSprings(stiffness, strain);
      return;
    }
    // The force within a gap is proportional to it as long as it is small.
    for (const double half : LogGrid(0.01 * strain.cwiseAbs().maxCoeff(),
                                     strain.cwiseAbs().maxCoeff(), 8)) {
      const VectorXd given = stiffness * strain.cwiseMax(-half).cwiseMin(half);
      trials_.push_back(
          {given, JointEntry(1), [half](const Amplitudes& a) -> Parameters {
             if (a[0] <= 0.0) return std::nullopt;
             return Shape{{"gap", 2.0 * half * std::min(a[0], 3.0)}};
           }});
    }
  }
}

/// A spring that is much softer or stiffer moves a resonance away from where the motion
/// of the present plant has it: that is no first order.
void TrialMaker::AddOtherSprings(double stiffness, const VectorXd& strain) {
  for (const double factor : LogGrid(0.4, 2.5, 16)) {
    VectorXd moved;
    try {
      moved = MotionWithSpring(model_, candidate_.joint, (factor - 1.0) * stiffness,
                               strain, motion_.sample_time, plant_.opt.timestep);
    } catch (const NumericalError&) {
      continue;
    }
    trials_.push_back({-stiffness * moved, JointEntry(1),
                       [factor](const Amplitudes& a) -> Parameters {
                         if (a[0] * (factor - 1.0) <= 0.0) return std::nullopt;
                         return Shape{{"factor", factor}};
                       }});
  }
}

void TrialMaker::MakeDrives() {
  const std::string& effect = candidate_.cause.spec.effect;
  const double tick = motion_.sample_time;
  if (effect == "force_offset") {
    AddLinear(VectorXd::Ones(motion_.samples()), JointEntry(1), {"force"});
  } else if (effect == "motor_constant") {
    AddLinear(u(), MotorEntry(1), {"factor"}, 1.0, true);
  } else if (effect == "position_dependent_motor_constant") {
    MatrixXd parts(q().size(), 2);
    parts << q().cwiseProduct(u()), q().cwiseAbs2().cwiseProduct(u());
    AddLinear(parts, MotorEntry(2), {"slope", "curvature"});
  } else if (effect == "force_saturation") {
    const double top = u().cwiseAbs().maxCoeff();
    // The last of them cut off the very peaks.
    for (const double cut : {0.7, 0.5, 0.35, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3,
                             1e-3, 5e-4, 2e-4, 1e-4}) {
      const double limit = (1.0 - cut) * top;
      trials_.push_back({u().cwiseMax(-limit).cwiseMin(limit) - u(), MotorEntry(1),
                         [limit](const Amplitudes& a) -> Parameters {
                           if (a[0] <= 0.0) return std::nullopt;
                           return Shape{{"limit", limit}};
                         }});
    }
  } else if (effect == "input_delay") {
    trials_.push_back(
        {Delayed(u()) - u(), MotorEntry(1), [tick](const Amplitudes& a) -> Parameters {
           if (a[0] <= 0.0) return std::nullopt;
           return Shape{{"delay", std::min(a[0] * tick, 0.1)}};
         }});
  } else if (effect == "amplifier_lag") {
    for (const double ticks : {0.5, 4.0, 30.0}) {
      trials_.push_back({Lagged(u(), ticks) - u(), MotorEntry(1),
                         [ticks, tick](const Amplitudes& a) -> Parameters {
                           if (a[0] <= 0.0) return std::nullopt;
                           return Shape{{"time_constant", ticks * tick * a[0]}};
                         }});
    }
  }
}

void TrialMaker::MakeStructure() {
  const std::string& effect = candidate_.cause.spec.effect;
  if (effect == "added_mass") {
    AddLinear(-motion_.acceleration.row(candidate_.joint).transpose(), JointEntry(1),
              {"mass"});
  } else if (effect == "flexible_mode") {
    const double highest = 0.2 / motion_.sample_time;
    for (const double frequency : LogGrid(2e-3 * highest, highest, 40)) {
      for (const double ratio : {0.01, 0.05, 0.2}) {
        trials_.push_back(
            {AppendagePull(q(), frequency, ratio, motion_.sample_time), JointEntry(1),
             [frequency, ratio](const Amplitudes& a) -> Parameters {
               if (a[0] <= 0.0) return std::nullopt;
               return Shape{
                   {"mass", a[0]}, {"frequency", frequency}, {"damping_ratio", ratio}};
             }});
      }
    }
  } else if (effect == "end_stop") {
    for (const double share : {0.3, 0.6, 0.8, 0.9, 0.95, 0.99}) {
      for (const double side : {q().maxCoeff(), q().minCoeff()}) {
        const double position = share * side;
        if (std::abs(position) < 0.05 * Range(q())) continue;
        VectorXd beyond = q().array() - position;
        if (position > 0.0) {
          beyond = beyond.cwiseMax(0.0).eval();
        } else {
          beyond = beyond.cwiseMin(0.0).eval();
        }
        trials_.push_back(
            {-beyond, JointEntry(1), [position](const Amplitudes& a) -> Parameters {
               if (a[0] <= 0.0) return std::nullopt;
               return Shape{{"position", position}, {"stiffness", a[0]}};
             }});
      }
    }
  }
}

void TrialMaker::MakeEncoder() {
  const std::string& effect = candidate_.cause.spec.effect;
  if (effect == "encoder_scale") AddReading(y(), "factor", 1.0);
  if (effect == "encoder_drift") {
    AddReading(VectorXd::LinSpaced(
                   motion_.samples(), 0.0,
                   static_cast<double>(motion_.samples() - 1) * motion_.sample_time),
               "rate", 0.0);
  }
}

void TrialMaker::MakeKnob() {
  for (const FaultKnob& knob : FaultKnobs(plant_)) {
    if (knob.name != candidate_.cause.spec.effect) continue;
    if (knob.kind == KnobKind::kGear) {
      AddLinear(u(), MotorEntry(1), {"value"}, 1.0, true);
      return;
    }
    const Index joints = static_cast<Index>(knob.elements.size());
    MatrixXd signals(motion_.samples(), joints);
    MatrixXd entry = MatrixXd::Zero(model_.M.rows(), joints);
    for (Index i = 0; i < joints; ++i) {
      const int joint = knob.elements[static_cast<std::size_t>(i)];
      const int dof = plant_.jnt_dofadr[joint];
      const int address = plant_.jnt_qposadr[joint];
      entry(dof, i) = 1.0;
      if (knob.kind == KnobKind::kDamping) {
        signals.col(i) = -plant_.dof_damping[dof] * motion_.velocity.row(dof);
      } else {
        const double rest = plant_.qpos_spring[address] - plant_.qpos0[address];
        signals.col(i) = -plant_.jnt_stiffness[joint] *
                         (motion_.position.row(dof).array() - rest).matrix();
      }
    }
    AddLinear(signals, entry, {"value"}, 1.0, true);
    trials_.back().summed = true;
    return;
  }
}

std::vector<Trial> TrialMaker::Make() {
  if (candidate_.cause.fault) {
    MakeKnob();
  } else {
    MakeFriction();
    MakeSprings();
    MakeDrives();
    MakeStructure();
    MakeEncoder();
  }
  // What does not move does not show.
  std::erase_if(trials_, [](const Trial& trial) {
    return !trial.signals.allFinite() || trial.signals.cwiseAbs().maxCoeff() == 0.0;
  });
  return std::move(trials_);
}

}  // namespace

std::vector<Trial> MakeTrials(const mjModel& plant, const MechanicalModel& model,
                              const Candidate& candidate,
                              const ObservedMotion& motion) {
  return TrialMaker(plant, model, candidate, motion).Make();
}

namespace {

/// Sine and cosine of an angle, of which `name` is the parameter.
Trial WaveTrial(const MechanicalModel& model, const Candidate& candidate,
                const VectorXd& angle, const std::string& name, double value) {
  Trial trial;
  trial.signals.resize(angle.size(), 2);
  trial.signals << angle.array().sin(), angle.array().cos();
  if (FindEffect(candidate.cause.spec.effect).element() == mjOBJ_JOINT) {
    const VectorXd entry = VectorXd::Unit(model.M.rows(), candidate.joint);
    trial.entry = entry.replicate(1, 2);
  }
  trial.parameters = [name, value](const Amplitudes& a) -> Parameters {
    const auto [amplitude, phase] = AmplitudeAndPhase(a[0], a[1]);
    return std::map<std::string, double>{
        {"amplitude", amplitude}, {name, value}, {"phase", phase}};
  };
  return trial;
}

/// The readings at samples as their neighbours have them, two on either side: what is
/// made of a reading and compared with its own innovation must not hold its noise.
VectorXd WithoutOwnNoise(const VectorXd& y) {
  const Index n = y.size();
  VectorXd x = y;
  for (Index k = 2; k + 2 < n; ++k) {
    x[k] = (4.0 * (y[k - 1] + y[k + 1]) - y[k - 2] - y[k + 2]) / 6.0;
  }
  return x;
}

Sweep PeriodSweep(const MechanicalModel& model, const Candidate& candidate,
                  const VectorXd& x, bool encoder) {
  const double range = Range(x);
  Sweep sweep;
  // From half a period over the stroke on; a quarter or half of a period over the
  // stroke from one to the next misses no maximum. A scale may have far finer errors
  // than a motor has poles.
  const int finest = encoder ? 1600 : 240;
  const int step = encoder ? 2 : 1;
  for (int m = 2; m <= finest; m += step) sweep.values.push_back(4.0 * range / m);
  sweep.angle = 2.0 * kTurn / (4.0 * range) * x;
  sweep.increment = step * kTurn / (4.0 * range) * x;
  // What goes by faster than the observer follows by far.
  sweep.fast_below = encoder ? range / 6.0 : 0.0;
  sweep.make = [&model, &candidate, x, fast_below = sweep.fast_below](double period) {
    Trial trial = WaveTrial(model, candidate, kTurn / period * x, "period", period);
    trial.fast = period < fast_below;
    return trial;
  };
  return sweep;
}

Sweep FrequencySweep(const MechanicalModel& model, const Candidate& candidate,
                     const ObservedMotion& motion, double duration) {
  const double highest = std::min(0.1 / motion.sample_time, 250.0);
  const double spacing = 0.7 / duration;
  Sweep sweep;
  for (double f = 2.0 * spacing; f < highest; f += spacing) sweep.values.push_back(f);
  const Index n = motion.samples();
  const VectorXd time =
      motion.sample_time * VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1));
  sweep.angle = kTurn * 2.0 * spacing * time;
  sweep.increment = kTurn * spacing * time;
  sweep.make = [&model, &candidate, time](double frequency) {
    return WaveTrial(model, candidate, kTurn * frequency * time, "frequency",
                     frequency);
  };
  return sweep;
}

}  // namespace

std::optional<Sweep> MakeSweep(const MechanicalModel& model, const Candidate& candidate,
                               const ObservedMotion& motion, double duration) {
  const std::string& effect = candidate.cause.spec.effect;
  if (effect == "floor_vibration") {
    return FrequencySweep(model, candidate, motion, duration);
  }
  const bool encoder = effect == "encoder_periodic_error";
  if (!encoder && effect != "force_ripple") return std::nullopt;
  const VectorXd x = encoder ? WithoutOwnNoise(motion.outputs.row(candidate.channel))
                             : VectorXd(motion.position.row(candidate.joint));
  if (Range(x) == 0.0) return std::nullopt;
  return PeriodSweep(model, candidate, x, encoder);
}

std::pair<double, double> AmplitudeAndPhase(double a, double b) {
  return {std::hypot(a, b), std::atan2(b, a)};
}

}  // namespace mjdiag
