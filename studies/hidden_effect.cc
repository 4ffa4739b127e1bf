#include "mjdiag/studies/hidden_effect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Values = std::map<std::string, double>;

// DrawEffect meets the size that it draws to a fifth.
constexpr double kOwnShare = 0.8;

/// What the sizes of effects are measured in: the nominal run at a candidate's site.
struct Scales {
  double stroke = 0.0;     ///< of the joint [m, rad]
  double speed = 0.0;      ///< its largest
  double force = 0.0;      ///< the largest command of the motor that moves it
  double stiffness = 0.0;  ///< of the joint's spring
  double strain = 0.0;     ///< largest, of that spring
  double damping = 0.0;
  double mass = 0.0;
  double duration = 0.0;
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  double Uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(generator_);
  }
  double Log(double from, double to) {
    return std::exp(Uniform(std::log(from), std::log(to)));
  }
  double Sign() { return Uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0; }
  std::size_t Index(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(generator_);
  }

 private:
  std::mt19937_64 generator_;
};

/// Values at a size from 0 (nothing) to 1 (large).
using Sized = std::function<Values(double size)>;

Sized Proportional(const std::string& name, double large) {
  return [=](double s) { return Values{{name, s * large}}; };
}
Sized Factor(const std::string& name, double change) {
  return [=](double s) { return Values{{name, 1.0 + s * change}}; };
}

/// The shape of an effect, and how it grows. Ranges are those of machines: dry friction
/// of a few per cent of the motor's force, and so on.
Sized DrawShape(const std::string& type, const Scales& k, Random& r) {
  constexpr double kPi = std::numbers::pi;
  const double force = 0.05 * k.force;
  if (type == "coulomb_friction") return Proportional("force", force);
  if (type == "force_offset") return Proportional("force", r.Sign() * 0.3 * force);
  if (type == "viscous_friction") {
    return Proportional("coefficient", force / k.speed);
  }
  if (type == "quadratic_drag") {
    return Proportional("coefficient", force / (k.speed * k.speed));
  }
  if (type == "stribeck_friction") {
    const double share = r.Uniform(0.2, 1.0);
    const double velocity = k.speed * r.Log(0.01, 0.2);
    return [=](double s) {
      return Values{{"coulomb", s * share * force},
                    {"breakaway", s * force},
                    {"velocity", velocity}};
    };
  }
  if (type == "asymmetric_viscous_friction") {
    const double up = r.Uniform(0.2, 1.0) * force / k.speed;
    const double down = up * r.Uniform(1.5, 4.0);
    return [=](double s) {
      return Values{{"positive", s * up}, {"negative", s * down}};
    };
  }
  if (type == "presliding_hysteresis") {
    const double length = k.stroke * r.Log(1e-3, 0.1);
    return [=](double s) {
      return Values{{"force", s * force}, {"stiffness", s * force / length}};
    };
  }
  if (type == "hysteretic_stiffness") {
    const double length = k.stroke * r.Log(0.02, 0.3);
    const double loss = r.Uniform(0.3, 2.0);
    const double stiffness = 0.3 * force / k.stroke;
    return [=](double s) {
      return Values{{"stiffness", s * stiffness}, {"loss", loss}, {"length", length}};
    };
  }
  if (type == "force_ripple" || type == "encoder_periodic_error") {
    const bool ripple = type == "force_ripple";
    const double period = k.stroke * (ripple ? r.Log(0.05, 1.0) : r.Log(0.005, 0.3));
    const double phase = r.Uniform(-kPi, kPi);
    const double amplitude = ripple ? 0.3 * force : 1e-3 * k.stroke;
    return [=](double s) {
      return Values{{"amplitude", s * amplitude}, {"period", period}, {"phase", phase}};
    };
  }
  if (type == "position_dependent_motor_constant") {
    const double slope = r.Sign() * r.Uniform(0.2, 1.0) * 0.1 / k.stroke;
    const double curvature =
        r.Sign() * r.Uniform(0.2, 1.0) * 0.1 / (k.stroke * k.stroke);
    return [=](double s) {
      return Values{{"slope", s * slope}, {"curvature", s * curvature}};
    };
  }
  if (type == "motor_constant") return Factor("factor", r.Sign() * 0.1);
  if (type == "force_saturation") {
    return [=](double s) { return Values{{"limit", k.force * (1.0 - 0.5 * s)}}; };
  }
  if (type == "input_delay") return Proportional("delay", 2e-4);
  if (type == "amplifier_lag") return Proportional("time_constant", 2e-4);
  if (type == "linear_stiffness") return Proportional("stiffness", force / k.stroke);
  if (type == "cubic_stiffness") {
    return Proportional("coefficient", force / std::pow(k.stroke, 3));
  }
  if (type == "structural_stiffness") return Factor("factor", r.Sign() * 0.5);
  if (type == "added_mass") return Proportional("mass", 0.1 * k.mass);
  if (type == "flexible_mode") {
    const double frequency = r.Log(40.0, 400.0);
    const double ratio = r.Uniform(0.01, 0.1);
    return [=](double s) {
      return Values{{"mass", s * 0.05 * k.mass},
                    {"frequency", frequency},
                    {"damping_ratio", ratio}};
    };
  }
  if (type == "backlash") return Proportional("gap", k.strain);
  if (type == "end_stop") {
    const double position = r.Uniform(0.5, 0.95) * k.stroke;
    return [=](double s) {
      return Values{{"position", position},
                    {"stiffness", s * force / (0.1 * k.stroke)}};
    };
  }
  if (type == "floor_vibration") {
    const double frequency = r.Log(8.0, 200.0);
    const double phase = r.Uniform(-kPi, kPi);
    return [=](double s) {
      return Values{
          {"amplitude", s * 2000.0}, {"frequency", frequency}, {"phase", phase}};
    };
  }
  if (type == "encoder_scale") return Factor("factor", r.Sign() * 0.01);
  if (type == "encoder_drift") {
    return Proportional("rate", r.Sign() * 0.02 * k.stroke / k.duration);
  }
  if (type == "fault") return Factor("value", r.Sign() * 0.5);
  throw InputError("hidden effect", "no draw for '" + type + "'",
                   "a name of the catalogue");
}

Excitation NominalMotion(const Setup& setup) {
  return FollowTrajectory(setup, setup.trajectories.Find(setup.trajectories.fallback));
}

/// A trajectory that the record does not have: the shortest of all axes at once.
const Trajectory& UnseenTrajectory(const Setup& setup) {
  const Trajectory* best = &setup.trajectories.all.front();
  std::size_t most = 0;
  for (const Trajectory& trajectory : setup.trajectories.all) {
    if (trajectory.name == setup.trajectories.fallback) continue;
    if (trajectory.moves.front().by.size() <= most) continue;
    most = trajectory.moves.front().by.size();
    best = &trajectory;
  }
  return *best;
}

/// A run with those causes in the machine.
Record RunWithCauses(const Machine& machine, const std::vector<Cause>& causes,
                     const Excitation& motion, std::uint64_t seed, double noise) {
  RunOptions options;
  options.seed = seed;
  options.noise_scale = noise;
  return Simulate(machine.With(ChangesOf(causes)), motion, options);
}

/// The nominal motion posed with the noise of that seed.
DiscoveryProblem PoseNominal(const Machine& machine, std::uint64_t seed) {
  RunOptions noisy;
  noisy.seed = seed;
  return PoseProblem(machine, Simulate(machine, NominalMotion(machine.setup()), noisy),
                     1.0, 0.0);
}

/// What a cause adds without noise: the scaled innovations of the nominal plant on a
/// clean run.
VectorXd CleanResidual(const DiscoveryProblem& problem, const Cause& cause) {
  const Setup& setup = problem.machine.setup();
  DiscoveryProblem clean = problem;
  clean.run = ToMeasuredRun(
      setup, RunWithCauses(problem.machine, {cause}, NominalMotion(setup), 1, 0.0));
  return clean.Residual({});
}

/// The least squared innovations that any of the columns adds beside what the
/// amplitudes of all others explain.
double LeastOwnShare(const Eigen::MatrixXd& columns) {
  double least = std::numeric_limits<double>::infinity();
  if (columns.cols() < 2) return least;
  for (Index i = 0; i < columns.cols(); ++i) {
    Eigen::MatrixXd others(columns.rows(), columns.cols() - 1);
    others << columns.leftCols(i), columns.rightCols(columns.cols() - 1 - i);
    const VectorXd explained = others * LeastSquares(others, columns.col(i));
    least = std::min(least, (columns.col(i) - explained).squaredNorm());
  }
  return least;
}

Scales MeasureScales(const DiscoveryProblem& problem, const Candidate& candidate,
                     const Record& nominal) {
  const mjModel& plant = problem.machine.plant();
  const auto joint = static_cast<int>(candidate.joint);
  const int id = plant.dof_jntid[joint];
  const std::string name =
      "joint." + problem.machine.linear().coordinates[static_cast<std::size_t>(joint)];
  const VectorXd& q = nominal.At(name).samples;
  const double tick = nominal.sample_time();
  Scales scales;
  scales.stroke = q.maxCoeff() - q.minCoeff();
  scales.speed =
      (q.tail(q.size() - 1) - q.head(q.size() - 1)).cwiseAbs().maxCoeff() / tick;
  const std::vector<Index> driven = DrivenJoints(problem.machine.linear());
  std::size_t motor = 0;
  for (std::size_t u = 0; u < driven.size(); ++u) {
    if (driven[u] == candidate.joint) motor = u;
  }
  scales.force = nominal.At(problem.machine.channels().actuators[motor].channel)
                     .samples.cwiseAbs()
                     .maxCoeff();
  scales.stiffness = plant.jnt_stiffness[id];
  const int address = plant.jnt_qposadr[id];
  scales.strain = (q.array() - plant.qpos_spring[address]).abs().maxCoeff();
  scales.damping = plant.dof_damping[joint];
  scales.mass = problem.machine.linear().M(joint, joint);
  scales.duration = nominal.duration();
  return scales;
}

}  // namespace

HiddenCase MakeCase(const Machine& machine, const std::vector<Cause>& truth,
                    std::uint64_t seed) {
  HiddenCase hidden;
  hidden.truth = truth;
  hidden.record =
      RunWithCauses(machine, truth, NominalMotion(machine.setup()), seed, 1.0);
  const Excitation other =
      FollowTrajectory(machine.setup(), UnseenTrajectory(machine.setup()));
  hidden.unseen = RunWithCauses(machine, truth, other, seed + 1, 1.0);
  hidden.unseen_clean = RunWithCauses(machine, truth, other, seed, 0.0);
  return hidden;
}

Cause DrawEffect(const Machine& machine, const std::string& type,
                 const HiddenSize& size, std::uint64_t seed) {
  Random random(seed);
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  quiet.log_joints = true;
  const Excitation motion = NominalMotion(machine.setup());
  const Record nominal = Simulate(machine, motion, quiet);
  const DiscoveryProblem problem = PoseNominal(machine, seed);

  if (type == "encoder_noise") {
    const SensorSetup& sensor =
        machine.channels().sensors[random.Index(machine.channels().sensors.size())];
    return {{type, sensor.element, {{"sd", sensor.noise_sd * random.Log(0.5, 10.0)}}},
            false};
  }
  std::vector<Candidate> sites;
  for (const Candidate& candidate : AllSites(machine)) {
    const bool fits =
        type == "fault" ? candidate.cause.fault : candidate.cause.spec.effect == type;
    if (fits) sites.push_back(candidate);
  }
  const Candidate& site = sites[random.Index(sites.size())];
  const Sized shape = DrawShape(type, MeasureScales(problem, site, nominal), random);
  const auto at = [&](double scale) {
    Cause cause = site.cause;
    cause.spec.parameters = shape(scale);
    return cause;
  };
  const auto shows = [&](double scale) {
    return CleanResidual(problem, at(scale)).squaredNorm();
  };
  const double target = random.Log(size.least, size.most);
  double scale = 1.0;
  double shown = shows(scale);
  if (shown <= target) return at(scale);
  // Roughly with its square; a few steps of the secant in logarithms.
  double before_scale = scale;
  double before = shown;
  scale *= std::sqrt(target / shown);
  for (int i = 0; i < 6; ++i) {
    shown = shows(scale);
    if (shown > 0.0 && std::abs(std::log(shown / target)) < 0.2) break;
    double slope = 2.0;
    if (shown > 0.0 && shown != before) {
      slope = std::clamp(std::log(shown / before) / std::log(scale / before_scale), 1.0,
                         8.0);
    }
    before = std::max(shown, 1e-300);
    before_scale = scale;
    scale =
        std::clamp(scale * std::pow(target / before, 1.0 / slope), scale / 30.0, 1.0);
  }
  return at(scale);
}

std::vector<Cause> DrawEffects(const Machine& machine,
                               const std::vector<std::string>& types,
                               const HiddenSize& size, std::uint64_t seed) {
  constexpr std::uint64_t kDraws = 50;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    std::vector<Cause> causes;
    for (std::size_t i = 0; i < types.size(); ++i) {
      causes.push_back(
          DrawEffect(machine, types[i], size, 1000 * seed + 10 * draw + i));
    }
    if (causes.size() < 2) return causes;
    const DiscoveryProblem problem = PoseNominal(machine, seed);
    Eigen::MatrixXd columns(problem.run.outputs.size(), 0);
    for (const Cause& cause : causes) {
      if (cause.spec.effect == "encoder_noise") continue;  // like nothing else
      columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
      columns.rightCols(1) = CleanResidual(problem, cause);
    }
    if (LeastOwnShare(columns) >= kOwnShare * size.least) return causes;
  }
  throw NumericalError("hidden effects: no draw of these types tells them apart");
}

}  // namespace mjdiag
