// Friction, damping and springs take energy or store it, whatever values a fit may give
// them: their joint is moved along closed paths, and what it gave over them is added up.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kSteps = 1000;   // of the physics, once round the path
constexpr Index kSubsteps = 10;  // to a control tick
constexpr double kStroke = 2e-3;

/// q(t) that begins at rest, comes back after kSteps steps and begins again.
struct ClosedPath {
  VectorXd q = VectorXd::Zero(kSteps);
  VectorXd v = VectorXd::Zero(kSteps);

  ClosedPath(double step, Random& random) {
    const double turn = 2.0 * M_PI / (step * static_cast<double>(kSteps));
    for (const double swings : {1.0, 2.0, 5.0}) {
      const double size = random.Normal();
      const double w = swings * turn;
      for (Index k = 0; k < kSteps; ++k) {
        const double angle = w * step * static_cast<double>(k);
        q[k] += size * (1.0 - std::cos(angle));
        v[k] += size * w * std::sin(angle);
      }
    }
    const double scale = kStroke / (q.maxCoeff() - q.minCoeff());
    q *= scale;
    v *= scale;
  }
};

/// What a record of that path at one joint has, the others at rest.
ObservedMotion MotionOf(const Machine& machine, Index joint, const ClosedPath& path,
                        double command) {
  const mjModel& plant = machine.plant();
  constexpr Index kTicks = kSteps / kSubsteps;
  ObservedMotion motion;
  motion.sample_time = plant.opt.timestep * kSubsteps;
  motion.time = VectorXd::LinSpaced(
      kTicks, 0.0, motion.sample_time * static_cast<double>(kTicks - 1));
  motion.position = Eigen::MatrixXd::Zero(plant.nv, kTicks);
  motion.velocity = motion.acceleration = motion.position;
  for (Index k = 0; k < kTicks; ++k) {
    motion.position(joint, k) = path.q[k * kSubsteps];
    motion.velocity(joint, k) = path.v[k * kSubsteps];
  }
  motion.inputs = Eigen::MatrixXd::Constant(plant.nu, kTicks, command);
  motion.outputs =
      motion.position.topRows(static_cast<Index>(machine.channels().sensors.size()));
  return motion;
}

/// Within the bounds of a parameter, now and then at one of them; sizes over five decades
/// about the machine's own.
double DrawWithin(const FitParameter& parameter, double unit, Random& random) {
  const double kind = random.Uniform(0.0, 1.0);
  const bool has_lower = parameter.lower > -1e300;
  // The smallest positive number stands for "> 0".
  const bool is_open = parameter.lower == std::numeric_limits<double>::min();
  if (kind < 0.2 && has_lower && !is_open) return parameter.lower;
  if (kind > 0.9 && parameter.upper < 1e300) return parameter.upper;
  if (parameter.lower > 1e-300 && parameter.upper < 1e300) {
    return random.Log(parameter.lower, parameter.upper);
  }
  if (has_lower && parameter.upper < 1e300) {
    return random.Uniform(parameter.lower, parameter.upper);
  }
  const double size = unit * random.Log(1e-3, 1e2);
  const double value = parameter.lower < 0.0 ? random.Sign() * size : size;
  return std::clamp(value, parameter.lower, parameter.upper);
}

VectorXd DrawWithin(const Candidate& candidate, const Scales& scales, Random& random) {
  VectorXd values(static_cast<Index>(candidate.parameters.size()));
  Index i = 0;
  for (const FitParameter& parameter : candidate.parameters) {
    const auto place = static_cast<std::size_t>(i);
    const double own = MachineUnit(scales, candidate.effect->parameters()[place].unit);
    values[i++] = DrawWithin(parameter, std::isfinite(own) ? own : 1.0, random);
  }
  return values;
}

struct Energy {
  double given = 0.0;   // by the machine to what moves it [J]
  double turned = 0.0;  // to and fro
};

/// Twice round the path, with the effect in the plant and a constant command.
Energy EnergyOver(const Machine& machine, const PlacedEffect& placed, int dof,
                  const ClosedPath& path, double command) {
  const ModelPtr model = CopyModel(machine.plant());
  ApplyEffect(*model, placed);
  ActiveEffects effects(machine.channels(), *model, {placed});
  const DataPtr data = MakeData(*model);
  const int address = model->jnt_qposadr[model->dof_jntid[dof]];
  const double h = model->opt.timestep;
  Energy energy;
  for (Index k = 0; k < 2 * kSteps; ++k) {
    const Index at = k % kSteps;
    const double v = path.v[at];
    data->time = h * static_cast<double>(k);
    data->qpos[address] = model->qpos0[address] + path.q[at];
    data->qvel[dof] = v;
    mj_step1(model.get(), data.get());
    std::fill_n(data->ctrl, model->nu, command);
    effects.Act(*model, *data);
    double force = data->qfrc_applied[dof] + data->qfrc_passive[dof];
    for (int i = 0; i < data->nefc; ++i) {
      if (data->efc_type[i] != mjCNSTR_FRICTION_DOF || data->efc_id[i] != dof) continue;
      force -= std::copysign(data->efc_frictionloss[i], v);
    }
    energy.given += force * v * h;
    energy.turned += std::abs(force * v) * h;
  }
  return energy;
}

/// Laws that may work: a force from outside, and one that nobody knows.
const std::set<std::string> kActive{"floor_vibration", "force_curve"};

bool HasToBePassive(const Candidate& candidate) {
  const Family family = candidate.effect->family();
  return !candidate.effect->IsFault() && candidate.effect->element() == mjOBJ_JOINT &&
         (family == Family::kFriction || family == Family::kStructure) &&
         !kActive.contains(candidate.effect->name());
}

class PassiveLaws : public ::testing::Test {
 protected:
  /// Tries those candidates of a machine that have to be, at most at two sites each.
  void Try(const Machine& machine) {
    constexpr int kDraws = 8;
    // The sums are of first order in the step: what goes to and fro by a spring or an
    // appendage comes back but for that.
    constexpr double kOfTurned = 1e-2;
    Random random(7);
    std::map<std::string, int> sites;
    for (const Candidate& any : AllSites(machine)) {
      if (!HasToBePassive(any) || sites[any.effect->name()]++ > 1) continue;
      int refused = 0;
      for (int i = 0; i < kDraws; ++i) {
        const ClosedPath path(machine.plant().opt.timestep, random);
        const double command = random.Sign() * random.Log(0.1, 10.0);
        const ObservedMotion motion = MotionOf(machine, any.joint, path, command);
        std::vector<Candidate> one{any};
        BoundByRecord(one, machine, motion);
        const Site site{any.site, any.joint, any.channel};
        const Scales scales =
            ScalesOf({machine.plant(), machine.linear(), motion, site});
        const PlacedEffect placed{any.effect, any.site,
                                  DrawWithin(one[0], scales, random)};
        try {
          const Energy energy =
              EnergyOver(machine, placed, static_cast<int>(any.joint), path, command);
          EXPECT_LE(energy.given, kOfTurned * energy.turned + 1e-15)
              << FormatEffect(placed) << " under " << command;
        } catch (const InputError&) {
          ++refused;  // as a fit is
        }
      }
      EXPECT_LT(refused, kDraws / 2) << CandidateName(any);
      tried_.insert(any.effect->name());
    }
  }
  std::set<std::string> tried_;
};

TEST_F(PassiveLaws, GiveNoEnergyOverAClosedPath) {
  Try(test::Bonder());
  Try(test::Stage().machine);
  for (const Effect* effect : Effects()) {
    Candidate candidate;
    candidate.effect = Lasting(*effect);
    if (!HasToBePassive(candidate)) continue;
    EXPECT_TRUE(tried_.contains(effect->name())) << effect->name();
  }
}

// The stage has a damper of 203.5 N s/m.
TEST(ActiveLaws, AreRefused) {
  const test::Stage stage;
  const auto refusal = [&](const char* effect) {
    return test::MessageOf<InputError>([&] { stage.Measure({effect}); });
  };
  EXPECT_NO_THROW(
      stage.Measure({"asymmetric_viscous_friction@load:positive=-15,negative=0"}));
  EXPECT_NE(refusal("asymmetric_viscous_friction@load:positive=-215,negative=0")
                .find("takes away more damping than there is"),
            std::string::npos);
  EXPECT_NE(refusal("viscous_friction@load:coefficient=-215").find("more damping"),
            std::string::npos);
  EXPECT_NE(refusal("quadratic_drag@load:coefficient=-1").find("coefficient = -1"),
            std::string::npos);
}

}  // namespace
}  // namespace mjdiag
