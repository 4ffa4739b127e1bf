#pragma once
// A model behind the noise that suits it, fitted anew, until neither gains by the other.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/discovery/fit/model_fit.h"

namespace mjdiag {

struct SettledModel {
  ModelFit fit;
  FilterPath path;
  double score() const { return path.deviance + fit.prior + fit.occam; }
};

/// @param dofs     with a latent force
/// @param near     noises to begin with, that of the model so far the last
/// @param beat     a score: of what is nowhere near it nothing is fitted
/// @param hoped    what it is to gain by first order
/// @param is_over  ends it with what it has
/// NumericalError where no run with the first values stays with what was measured.
SettledModel Settle(const MachineWith& machine_with, const MeasuredRun& run,
                    const Eigen::VectorXd& reading_sd,
                    const std::vector<Eigen::Index>& dofs,
                    const std::vector<Block>& blocks, ModelFit fit,
                    const std::vector<FilterNoise>& near, double beat, double hoped,
                    const std::function<bool()>& is_over);

}  // namespace mjdiag
