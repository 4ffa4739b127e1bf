#pragma once
// A block: a hypothesis about what a machine lacks, as columns along its motion
// (column.h) with a price. Laws of the catalogue at their sites, each with its shapes on a
// grid (variations), and numbers of the plant.
//
// The price is -2 ln of how often it is what is missing, kMissing times the odds of its
// effect, 1 of a number, 2 ln of how many shapes it has, and what a claim has to be worth, odds of 1000;
// sizes are known beforehand to a spread, which follows from the machine's own scales
// (Effect::Spread).

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// A law with its shape, or a number: one or more columns with amplitudes of their own.
struct Variation {
  std::size_t block = 0;
  std::size_t shape = 0;  ///< which of the block's, from 0
  std::vector<Column> columns;
  Eigen::VectorXd sd;     ///< of every amplitude, as known beforehand
  Eigen::VectorXd least;  ///< of every amplitude; empty: anything
  /// Of the law's parameters, or of the number's factor; see CandidateRegressor::values.
  std::function<RegressorValues(const Amplitudes&)> values;
};

struct Block {
  std::string name;  ///< "coulomb_friction@X", "mass@stage"
  std::optional<Candidate> candidate;
  std::optional<ModelParameter> number;
  double doubt = 0.0;  ///< of the number's logarithm, a standard deviation
  /// Blocks of one group are one thing in several shapes: a model has one of them. Empty:
  /// a group of its own, of which there may be several members.
  std::string group = {};
  /// The joint whose motion it resists; empty: none. What resists a joint is one curve over its
  /// velocity, of which dry and viscous friction are parts.
  std::string resists = {};
  double price = 0.0;

  bool HasShape() const;
  /// Of a joint, whatever it is proportional to.
  bool IsResistance() const;
  bool IsDryFriction() const;
  bool GrowsWithLoad() const;
  /// Dry friction of a joint that gives way at rest as MuJoCo's does by default.
  bool GivesWay() const;
  /// Dry friction of a joint that springs before it slides.
  bool Springs() const;
  /// Dry friction that holds by more than it slides by.
  bool BreaksAway() const;
  /// Dry friction that comes within a speed: a size and that.
  bool IsSmoothFriction() const;
  /// Changes what an actuator makes of its input.
  bool IsOfDrive() const;
  /// Of a body or a rotor.
  bool IsInertia() const;
  /// A sine and a cosine, of which there may be several.
  bool IsWave() const;
  /// A size and nothing that shapes it, as a load does.
  bool IsSimplest() const;
};

/// The motion of a run, and what of it does not change from block to block.
struct BlockMotion {
  ObservedMotion motion;
  Eigen::VectorXd reading_noise;   ///< ny
  double duration = 0.0;           ///< [s]
  std::vector<Eigen::Index> told;  ///< degrees of freedom that are driven or measured
};

/// Whether a number is at the end of what is known of it: it would be further off still, if
/// it might, and makes up for something else, or for a model of another machine.
bool HasActiveBound(const Block& block, const Eigen::VectorXd& values);
/// Whether values are such as its law, or the number, can have.
bool IsAllowed(const Block& block, const RegressorValues& values);

/// How probable it is that a model lacks an effect of odds 1 at a site where the machine
/// has it: models are made by people who know their machine.
inline constexpr double kMissing = 0.1;
/// So many spreads from what is known is another machine.
inline constexpr double kFarthest = 9.0;
/// So many times what it is said to be, or as many times less, is no motor's constant: an
/// input that does nothing is the cheapest explanation of a joint that rubs.
inline constexpr double kMostTimes = 3.0;
/// 2 ln 1000: the likelihood of a filter is known as well as the search for its noise ends,
/// to some units, and many are looked at.
inline constexpr double kClaim = 13.8;

/// What a size costs that is x of its standard deviations from what is known beforehand, in
/// -2 ln: Student's t of two degrees of freedom. What is known is mostly right, and where it
/// is not it may be far off.
double SizePrice(double x);
/// Of all sizes of a block with values.
double SizePrice(const Block& block, const Eigen::VectorXd& values);

/// Those of a machine: candidates, then numbers. A law that changes a number is one of them only
/// where no numbers are in doubt, or as a fault parameter, which then stands for the number.
std::vector<Block> BlocksOf(const Machine& machine,
                            const std::vector<Candidate>& candidates,
                            const std::vector<ModelParameter>& numbers);

/// Numbers of a plant, and centres of mass.
std::vector<ModelParameter> NumbersOf(const mjModel& plant);

/// The sweep of a block that repeats itself over a period or a frequency, if it does.
std::optional<ParameterScan> ParameterScanOf(const Machine& machine,
                                             const BlockMotion& along,
                                             const Block& block);
/// How large what acts at the site of a block is.
struct BlockScales {
  Scales site;
  Eigen::VectorXd spans;  ///< of every reading
};
BlockScales ScalesOf(const Machine& machine, const BlockMotion& along,
                     const Block& block);
/// One shape of a block; of no columns if it does nothing.
Variation VariationOf(std::size_t place, const Block& block, const BlockScales& scales,
                      const CandidateRegressor& trial, std::size_t shape);
/// What it costs that a block is what is missing, in as many shapes.
double PriceOf(const Block& block, Eigen::Index shapes);

/// Hands out every variation of a block without a sweep that the motion shows.
/// @param block  its price receives what its many shapes cost on top
void ForEachVariation(const Machine& machine, const BlockMotion& along,
                      std::size_t place, Block& block,
                      const std::function<void(Variation&&)>& take);

}  // namespace mjdiag
