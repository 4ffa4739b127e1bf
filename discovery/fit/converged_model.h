#pragma once
// A model behind the noise that suits it, fitted anew, until neither gains by the other.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "mjdiag/discovery/fit/model_fit.h"

namespace mjdiag {

struct ConvergedModel {
  ModelFit fit;
  FilterPath path;
  double score() const { return path.deviance + fit.prior + fit.occam; }
};

/// What models are settled beside.
struct ConvergedBeside {
  MachineWith machine_with;
  const MeasuredRun& run;
  const Eigen::VectorXd& reading_sd;
  const std::vector<Eigen::Index>& dofs;  ///< with a latent force
  const std::vector<Block>& blocks;
  /// Whether values and noises are asked as long as anything is gained; else, for models that
  /// further moves will change, until a round gains less than a hundredth of what all did.
  bool is_last = false;
  std::function<bool()> is_over;  ///< ends it with what it has
};

/// Models that may be in each other's place. Behind noises of their own each would be as
/// likely as the luck of its search for a noise: the best of them, and those that may reach it by
/// what they gain, are given the noises that suit them, round by round; the others are tried behind
/// that of the best, until it stays the best.
/// @param near   noises to begin with, that of the model so far the last
/// @param beat   a score: of what is nowhere near it nothing is fitted
/// @param hoped  what they are to gain by first order
/// Without those whose run with the first values does not stay with what was measured.
std::vector<std::optional<ConvergedModel>> SettleRivals(
    const ConvergedBeside& beside, std::vector<ModelFit> fits,
    const std::vector<FilterNoise>& near, double beat, double hoped);

/// Models with the values that they have in the place of a converged one, along its path.
/// @param hoped  what each may gain
std::vector<std::optional<ConvergedModel>> SettleInPlaceOf(
    const ConvergedModel& found, const ConvergedBeside& beside,
    const std::vector<Model>& models, double hoped);

/// From a path along the run that is near to what suits: fitted, and its noise anew, once.
ConvergedModel SettleNear(const ConvergedBeside& beside, ModelFit fit, FilterPath path);

/// Of one; NumericalError where it does not stay with what was measured.
ConvergedModel Settle(const ConvergedBeside& beside, ModelFit fit,
                      const std::vector<FilterNoise>& near, double beat, double hoped);

}  // namespace mjdiag
