#include "mjdiag/studies/hidden_effect.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/observed_runs.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Squared innovations.
constexpr double kLeastSize = 200.0;
constexpr double kMostSize = 1e8;
// DrawEffect meets the size that it draws to a fifth.
constexpr double kOwnShare = 0.8;

Excitation NominalMotion(const Setup& setup) {
  return FollowTrajectory(setup, setup.trajectories.Find(setup.trajectories.fallback));
}

/// A trajectory that the record does not have: the shortest of all axes at once.
const Trajectory& UnseenTrajectory(const Setup& setup) {
  const Trajectory* best = &setup.trajectories.all.front();
  std::size_t most = 0;
  for (const Trajectory& trajectory : setup.trajectories.all) {
    if (trajectory.name == setup.trajectories.fallback) continue;
    if (trajectory.moves.empty()) continue;  // tones alone
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

Scales MeasureScales(const Machine& machine, const Candidate& candidate,
                     const Record& nominal) {
  const mjModel& plant = machine.plant();
  const auto joint = static_cast<int>(candidate.joint);
  const int id = plant.dof_jntid[joint];
  const std::string name =
      "joint." + machine.linear().coordinates[static_cast<std::size_t>(joint)];
  const VectorXd& q = nominal.At(name).samples;
  const double tick = nominal.sample_time();
  Scales scales;
  scales.stroke = q.maxCoeff() - q.minCoeff();
  scales.speed =
      (q.tail(q.size() - 1) - q.head(q.size() - 1)).cwiseAbs().maxCoeff() / tick;
  const std::vector<Index> driven = DrivenJoints(machine.linear());
  std::size_t motor = 0;
  for (std::size_t u = 0; u < driven.size(); ++u) {
    if (driven[u] == candidate.joint) motor = u;
  }
  scales.force = nominal.At(machine.setup().channels.actuators[motor].channel)
                     .samples.cwiseAbs()
                     .maxCoeff();
  scales.stiffness = plant.jnt_stiffness[id];
  const int address = plant.jnt_qposadr[id];
  scales.strain = (q.array() - plant.qpos_spring[address]).abs().maxCoeff();
  scales.damping = plant.dof_damping[joint];
  scales.mass = machine.linear().M(joint, joint);
  scales.duration = nominal.duration();
  return scales;
}

}  // namespace

std::vector<Candidate> SitesOf(const Machine& machine, const std::string& type) {
  std::vector<Candidate> sites = AllSites(machine);
  std::erase_if(sites, [&](const Candidate& candidate) {
    return candidate.effect->IsFault() ? type != kFaultType
                                       : candidate.effect->name() != type;
  });
  return sites;
}

Cause DrawNoise(const Channels& channels, Random& random) {
  const SensorSetup& sensor = channels.sensors[random.Index(channels.sensors.size())];
  const Effect& noise = NoiseEffect();
  return {Lasting(noise), sensor.element,
          noise.Draw({.noise = sensor.noise_sd}, random)(1.0)};
}

std::vector<std::string> TypesOfRun(int run, int causes) {
  std::vector<const Effect*> drawn = Effects();
  std::erase_if(drawn, [](const Effect* effect) { return effect->odds() == kLearned; });
  const int size = static_cast<int>(drawn.size());
  std::vector<std::string> types;
  // A second effect is another type, and another pair every time round.
  for (int i = 0; i < causes; ++i) {
    const int number = (run + i * (7 + run / size)) % size;
    types.push_back(drawn[static_cast<std::size_t>(number)]->name());
  }
  return types;
}

HiddenCase MakeCase(const Machine& machine, const std::vector<Cause>& truth,
                    std::uint64_t seed) {
  HiddenCase hidden;
  hidden.truth = truth;
  hidden.measurements = MeasurementsOf(
      machine, RunWithCauses(machine, truth, NominalMotion(machine.setup()), seed, 1.0),
      nullptr);
  const Excitation other =
      FollowTrajectory(machine.setup(), UnseenTrajectory(machine.setup()));
  hidden.unseen = RunWithCauses(machine, truth, other, seed + 1, 1.0);
  hidden.unseen_clean = RunWithCauses(machine, truth, other, seed, 0.0);
  return hidden;
}

namespace {

/// One effect of that type.
Cause DrawEffect(const Machine& machine, const std::string& type, std::uint64_t seed) {
  Random random(seed);
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  quiet.log_joints = true;
  const Excitation motion = NominalMotion(machine.setup());
  const Record nominal = Simulate(machine, motion, quiet);
  const ObservedRuns runs(machine, motion);

  if (type == NoiseEffect().name()) return DrawNoise(machine.channels(), random);
  const std::vector<Candidate> sites = SitesOf(machine, type);
  if (sites.empty()) {
    throw InputError("hidden effect", "the machine has no site for '" + type + "'",
                     "an effect of docs/effects.md, or a fault");
  }
  const Candidate& site = sites[random.Index(sites.size())];
  const Sized shape = site.effect->Draw(MeasureScales(machine, site, nominal), random);
  const auto at = [&](double scale) {
    return Cause{site.effect, site.site, shape(scale)};
  };
  const auto shows = [&](double scale) {
    return runs.InnovationsOf(ChangesOf({at(scale)})).squaredNorm();
  };
  const double target = random.Log(kLeastSize, kMostSize);
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

}  // namespace

std::vector<Cause> DrawEffects(const Machine& machine,
                               const std::vector<std::string>& types,
                               std::uint64_t seed) {
  constexpr std::uint64_t kDraws = 50;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    std::vector<Cause> causes;
    for (std::size_t i = 0; i < types.size(); ++i) {
      causes.push_back(DrawEffect(machine, types[i], 1000 * seed + 10 * draw + i));
    }
    if (causes.size() < 2) return causes;
    const ObservedRuns runs(machine, NominalMotion(machine.setup()));
    std::vector<VectorXd> shown;
    for (const Cause& cause : causes) {
      if (cause.effect->form() == Form::kNoise) continue;  // like nothing else
      shown.push_back(runs.InnovationsOf(ChangesOf({cause})));
    }
    if (shown.empty()) return causes;
    Eigen::MatrixXd columns(shown.front().size(), std::ssize(shown));
    for (Index i = 0; i < columns.cols(); ++i) {
      columns.col(i) = shown[static_cast<std::size_t>(i)];
    }
    if (LeastOwnShare(columns) >= kOwnShare * kLeastSize) return causes;
  }
  throw NumericalError("hidden effects: no draw of these types tells them apart");
}

std::string ListOf(const std::vector<Cause>& causes) {
  std::string text;
  for (const Cause& cause : causes) {
    text += (text.empty() ? "" : "; ") + CauseWithValues(cause);
  }
  return text.empty() ? "nothing" : text;
}

std::vector<double> UnseenRatios(const Machine& machine, const Changes& changes,
                                 const Record& unseen, const Record& clean) {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  Record simulated;
  try {
    simulated = Simulate(machine.With(changes), Replay(machine.setup(), unseen), quiet);
  } catch (const NumericalError&) {
    return {};
  }
  std::vector<double> ratios;
  for (const SensorSetup& sensor : machine.channels().sensors) {
    const VectorXd& measured = unseen.At(sensor.channel).samples;
    const double floor = Rms(measured - clean.At(sensor.channel).samples);
    ratios.push_back(Rms(measured - simulated.At(sensor.channel).samples) / floor);
  }
  return ratios;
}

}  // namespace mjdiag
