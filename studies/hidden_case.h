#pragma once
// Cases of the benchmark of discovery: simulated measurements of a machine with something
// hidden in them. What has to find it sees the records and the model only. Either the model
// is exact (hidden_effect.h), or the machine is not quite its model:
//
// - Every number of the plant is what the model says times exp(s n), n standard normal
//   and s what is not known of it beforehand (DoubtOf); nothing is exact.
// - The measurement is made with twice the physics steps of the model.
// - One to three effects and fault parameters at once, or a law that the engine does not
//   have (outside_law.h), alone. Sizes are shares of what the machine itself does
//   (Effect::Draw), evenly in the logarithm from 0.005 to 1, raised to what the record can
//   show at least beside the wrong numbers, the other causes and, of a law with a simpler
//   one in it, that one (visible_size.h), or drawn anew. What another law of the catalogue
//   shows as well, with the other causes there, is drawn anew, too.
// - One record or two, the default motion and one with other strokes; in half of the
//   cases a further one that nothing is fitted to.

#include <cstdint>
#include <optional>
#include <vector>

#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/discovery/measurements.h"
#include "mjdiag/plugin/effects/draw.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// What is hidden.
struct HiddenPlan {
  int causes = 1;        ///< 0 to 3, from the catalogue
  bool outside = false;  ///< one law that is in no list instead
  bool exact = false;    ///< the machine is its model but for that; then no outside law
};

/// Of the case with that seed and a model that is not exact: outside laws in every fifth, of
/// the others one cause in 60 %, two in 25 %, three in 15 %.
HiddenPlan PlanOf(std::uint64_t seed);

struct HiddenCase {
  std::vector<Cause> truth;
  /// Joint that an outside law acts on; none: the truth is from the catalogue.
  std::optional<Eigen::Index> outside_joint;
  NumberFactors numbers;  ///< of the machine over those of the model
  Measurements measurements;
  Record unseen;        ///< of one more motion, with noise
  Record unseen_clean;  ///< the same without
};

/// What every cause shows at least (visible_size.h).
inline constexpr double kLeastShown = 200.0;
/// The same beside any other single law: five standard deviations, and what up to three
/// parameters that the other has not cost in a criterion, log n = 8 each.
inline constexpr double kLeastTold = 50.0;

/// Numbers of a plant as they may be.
/// @param spread  standard deviation of the logarithm of one
NumberFactors DrawNumbers(const mjModel& plant, Random& random,
                          double (*spread)(const mjModel& plant,
                                           const ModelParameter& number) = DoubtOf);

/// An exact model has one record of the default motion to be looked at, and causes of types
/// that follow one another from seed to seed. The same seed, the same case. InputError on a machine without a controller, which
/// follows no motion.
HiddenCase DrawHiddenCase(const Machine& model, const HiddenPlan& plan,
                          std::uint64_t seed);

}  // namespace mjdiag
