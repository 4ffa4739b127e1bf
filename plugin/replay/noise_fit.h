#pragma once
// The most likely noise of a machine beside a run (filter_noise.h). What a model lacks is
// noise of the model, and its intensity an unknown like any other: -2 ln L (force_filter.h)
// is least where the latent forces are as large as what is missing, and as lasting
// [Kristensen 2004]. Slow laws and a slow latent force explain each other, so that the search
// starts twice, from all slow and from all fast.
//
// Where it may be far off it is looked for along pieces of every record, of 3600 readings and
// up to four times as many of a small machine; then along all of the run (noise_search.h).

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/noise_search.h"

namespace mjdiag {

/// Asked while a noise is looked for: whether no time is left. What was found until then is the
/// answer. May be empty.
using IsTimeOver = std::function<bool()>;

/// Pieces of every record, each a record of its own: what is large shows there as in all of
/// the run.
/// @param dofs   with a latent force
/// @param least  share of the run
MeasuredRun PiecesOfRun(const Machine& machine, const MeasuredRun& run,
                        const std::vector<Eigen::Index>& dofs, double least = 0.0);

/// Noise behind which the filter follows a run whatever the machine lacks: forces as large
/// as what drives the joints.
/// @param reading_sd  of every sensor, by itself
FilterNoise FollowingNoise(const Machine& machine, const MeasuredRun& run,
                           const std::vector<Eigen::Index>& dofs,
                           const std::vector<FilterStart>& starts,
                           const Eigen::VectorXd& reading_sd);

/// The path of a run with its most likely noise: followed, fitted, followed behind what was
/// found, until nothing is gained. What a fit finds of a sensor is between a half of its own noise and a
/// hundred times that.
/// @param reading_sd  of every sensor, by itself
/// NumericalError as RunForceFilter.
FilterPath FilterLikeliest(const Machine& machine, const MeasuredRun& run,
                           const Eigen::VectorXd& reading_sd,
                           const IsTimeOver& is_over = {});

/// How far a likely noise is asked: behind what is likeliest by pieces another one may be
/// likelier of all of the run, by some hundred of -2 ln L.
enum class NoiseBy { kAllOfRun, kPieces };

/// The path of a run with the noise that is most likely from some near ones on.
/// @param dofs  with a latent force, of all of those noises
FilterPath FilterLikeliestFrom(const Machine& machine, const MeasuredRun& run,
                               const Eigen::VectorXd& reading_sd,
                               const std::vector<Eigen::Index>& dofs,
                               const std::vector<FilterNoise>& near,
                               const IsTimeOver& is_over = {},
                               NoiseBy by = NoiseBy::kAllOfRun);

/// The path of a machine along a run with a noise that is likelier, from its own on.
/// @param readings  so many say which
FilterPath FilterLikelier(const Machine& machine, const MeasuredRun& run,
                          const Eigen::VectorXd& reading_sd, FilterPath path,
                          const IsTimeOver& is_over = {},
                          Eigen::Index readings = kMostReadings);

/// The same of a machine that is all but the one whose noise it begins with.
FilterPath FilterLikeliestNear(const Machine& machine, const MeasuredRun& run,
                               const Eigen::VectorXd& reading_sd,
                               const std::vector<Eigen::Index>& dofs,
                               const FilterNoise& near, const IsTimeOver& is_over = {});

}  // namespace mjdiag
