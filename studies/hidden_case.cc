#include "mjdiag/studies/hidden_case.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/hidden_effect.h"
#include "mjdiag/studies/outside_law.h"
#include "mjdiag/studies/visible_size.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// Draws are another stream than noise, which has the seed itself.
constexpr std::uint64_t kDrawStream = 0x68617264;
constexpr std::uint64_t kEveryOutside = 5;  // cases
constexpr int kFiner = 2;        // physics steps of the measurement over the model's
constexpr double kTicks = 8000;  // of a record at most
constexpr double kLeastScale = 0.005;

/// The default motion, as long as a record may be.
Trajectory DefaultTrajectory(const Setup& setup) {
  if (setup.control.axes.empty()) {
    throw InputError("hidden causes", "'" + setup.name + "' has no controlled axes",
                     "a machine that follows a trajectory");
  }
  Trajectory trajectory = setup.trajectories.Find(setup.trajectories.fallback);
  trajectory.duration = std::min(trajectory.duration, kTicks * setup.rates.tick());
  return trajectory;
}

/// The same moves with other strokes, of every axis another share.
Trajectory OtherStrokes(Trajectory trajectory, Random& random) {
  std::map<std::string, double> shares;
  for (Move& move : trajectory.moves) {
    for (auto& [axis, by] : move.by) {
      if (!shares.contains(axis)) {
        shares[axis] = random.Sign() * random.Uniform(0.4, 0.9);
      }
      by *= shares[axis];
    }
  }
  return trajectory;
}

/// Of a type from the catalogue, a fault parameter now and then.
std::string DrawType(Random& random) {
  constexpr double kFaults = 0.15;
  if (random.Uniform(0.0, 1.0) < kFaults) return kFaultType;
  return Effects()[random.Index(Effects().size())]->name();
}

struct Placed {
  EffectPtr effect;
  Site site;
};

/// A site of an outside law, of the law of that number or the next one that has any.
Placed PlaceOutside(const Machine& machine, std::size_t number, Random& random) {
  const SiteMap map(machine.plant(), machine.linear(), machine.channels());
  for (;; ++number) {
    const Effect& law = *OutsideLaws()[number % OutsideLaws().size()];
    const std::vector<Site> sites = law.CandidateSites(map);
    if (!sites.empty()) return {Lasting(law), sites[random.Index(sites.size())]};
  }
}

/// A site of an effect of the catalogue; none if the machine has none.
std::optional<Placed> PlaceKnown(const Machine& machine, const std::string& type,
                                 Random& random) {
  const std::vector<Candidate> sites = SitesOf(machine, type);
  if (sites.empty()) return std::nullopt;
  const Candidate& one = sites[random.Index(sites.size())];
  return Placed{one.effect, {one.site, one.joint, one.channel}};
}

/// Raised to what is visible; none if even the largest is not, or nothing that runs.
std::optional<Cause> DrawSize(const VisibleSize& visible, const Placed& placed,
                              Random& random) {
  constexpr int kRaises = 4;
  constexpr double kAbove = 1.3;  // of the least, where it is raised
  const Sized shape = placed.effect->Draw(visible.ScalesAt(placed.site), random);
  double scale = random.Log(kLeastScale, 1.0);
  for (int i = 0; i < kRaises; ++i) {
    Cause cause{placed.effect, placed.site.name, shape(scale)};
    double shown = visible.Shown(cause, visible.NoOthers());
    if (shown >= kLeastShown) {
      shown = std::min(shown, visible.ShownBesideSimplerLaw(cause));
    }
    if (shown >= kLeastShown) {
      // What another law shows as well has no right name.
      if (visible.ShownBesideOtherLaws(cause) < kLeastTold) return std::nullopt;
      return cause;
    }
    if (scale >= 1.0) return std::nullopt;
    // Roughly with its square.
    const double raise = std::sqrt(kAbove * kLeastShown / std::max(shown, 1e-6));
    scale = std::min(1.0, scale * std::max(raise, kAbove));
  }
  return std::nullopt;
}

/// Whether each shows beside the others, and by its name.
bool ShowBesideEachOther(const VisibleSize& visible, std::vector<Cause> causes) {
  std::erase_if(causes, [](const Cause& cause) {
    return cause.effect->form() == Form::kNoise;  // like nothing else
  });
  for (std::size_t i = 0; i < causes.size(); ++i) {
    Eigen::MatrixXd others = visible.NoOthers();
    for (std::size_t k = 0; k < causes.size(); ++k) {
      if (k == i) continue;
      others.conservativeResize(Eigen::NoChange, others.cols() + 1);
      others.rightCols(1) = visible.Innovations(causes[k]);
    }
    if (visible.Shown(causes[i], others) < kLeastShown) return false;
    if (visible.ShownBesideOtherLaws(causes, i) < kLeastTold) return false;
  }
  return true;
}

std::optional<Cause> DrawKnown(const Machine& machine, const VisibleSize& visible,
                               Random& random) {
  const std::string type = DrawType(random);
  if (type == NoiseEffect().name()) return DrawNoise(machine.channels(), random);
  const auto placed = PlaceKnown(machine, type, random);
  return placed ? DrawSize(visible, *placed, random) : std::nullopt;
}

/// One that is none of the others, nor their image.
std::optional<Cause> DrawOneMore(const Machine& machine, const VisibleSize& visible,
                                 const std::vector<Cause>& others, Random& random) {
  const std::optional<Cause> cause = DrawKnown(machine, visible, random);
  if (!cause) return std::nullopt;
  const bool there = std::ranges::any_of(
      others, [&](const Cause& other) { return Indistinguishable(other, *cause); });
  if (there) return std::nullopt;
  std::vector<Cause> all = others;
  all.push_back(*cause);
  if (!others.empty() && !ShowBesideEachOther(visible, all)) return std::nullopt;
  return cause;
}

/// An outside law, another one where the machine shows nothing of it.
std::optional<Cause> DrawOutside(const Machine& machine, const VisibleSize& visible,
                                 std::size_t number, Random& random,
                                 std::optional<Index>& joint) {
  const Placed placed = PlaceOutside(machine, number, random);
  joint = placed.site.joint;
  return DrawSize(visible, placed, random);
}

/// Asks again while a draw is none or cannot be run.
template <typename Draw>
auto DrawUntilThere(const Draw& draw) {
  constexpr int kDraws = 100;
  for (int i = 0; i < kDraws; ++i) {
    try {
      if (auto drawn = draw()) return *std::move(drawn);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
      // takes away more than there is
    }
  }
  throw NumericalError("hidden effects: no draw of this machine can be seen");
}

}  // namespace

HiddenPlan PlanOf(std::uint64_t seed) {
  constexpr double kOne = 0.6;
  constexpr double kTwo = 0.25;
  if (seed % kEveryOutside == 0) return {.causes = 0, .outside = true};
  const double draw = Random(seed ^ (kDrawStream << 8)).Uniform(0.0, 1.0);
  return {.causes = draw < kOne ? 1 : draw < kOne + kTwo ? 2 : 3};
}

NumberFactors DrawNumbers(const mjModel& plant, Random& random,
                          double (*spread)(const mjModel& plant,
                                           const ModelParameter& number)) {
  NumberFactors factors;
  for (const ModelParameter& number : ModelParameters(plant)) {
    factors.emplace_back(number, std::exp(spread(plant, number) * random.Normal()));
  }
  return factors;
}

HiddenCase DrawHiddenCase(const Machine& model, const HiddenPlan& plan,
                          std::uint64_t seed) {
  if (plan.exact) {
    const auto types = TypesOfRun(static_cast<int>(seed - 1), plan.causes);
    return MakeCase(model, DrawEffects(model, types, seed), seed);
  }
  Random random(seed ^ kDrawStream);
  const Setup& setup = model.setup();
  const Trajectory trajectory = DefaultTrajectory(setup);
  const int substeps = kFiner * setup.rates.substeps;
  const Excitation motion = FollowTrajectory(setup, trajectory);
  HiddenCase hidden;
  const auto visible = DrawUntilThere([&]() -> std::optional<VisibleSize> {
    hidden.numbers = DrawNumbers(model.plant(), random);
    return VisibleSize(model.WithNumbers(hidden.numbers), substeps, motion);
  });
  if (plan.outside) {
    constexpr std::size_t kSites = 5;  // that are tried of a law
    std::size_t tried = 0;
    hidden.truth = {DrawUntilThere([&] {
      const std::size_t number = seed / kEveryOutside + tried++ / kSites;
      return DrawOutside(model, visible, number, random, hidden.outside_joint);
    })};
  }
  for (int i = 0; i < plan.causes; ++i) {
    hidden.truth.push_back(DrawUntilThere(
        [&] { return DrawOneMore(model, visible, hidden.truth, random); }));
  }

  const Machine machine = model.WithSubsteps(substeps)
                              .WithNumbers(hidden.numbers)
                              .With(ChangesOf(hidden.truth));
  std::uint64_t noise = 1000 * seed;
  const auto measure = [&](const Excitation& moved) {
    RunOptions options;
    options.seed = ++noise;
    return Simulate(machine, moved, options);
  };
  const auto other = [&] {
    return FollowTrajectory(setup, OtherStrokes(trajectory, random));
  };
  const bool two = random.Uniform(0.0, 1.0) < 0.5;
  const bool validated = random.Uniform(0.0, 1.0) < 0.5;
  hidden.measurements.fit.push_back({measure(motion), model, "default"});
  if (two) hidden.measurements.fit.push_back({measure(other()), model, "other"});
  if (validated) {
    hidden.measurements.unseen.push_back({measure(other()), model, "validation"});
  }
  const Excitation last = other();
  hidden.unseen = measure(last);
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  hidden.unseen_clean = Simulate(machine, last, quiet);
  return hidden;
}

}  // namespace mjdiag
