#pragma once
// A model fitted with MuJoCo's own ticks: the machine with it is followed with kept gains
// (kept_gains.h), and what its innovations leave is made least by all of its values at once,
//
//   |r(x)|^2 + sum of SizePrice(x) of what is known beforehand (block.h),
//
// by steps of Gauss and Newton within bounds, damped where nothing is gained (K. Levenberg 1944,
// D. W. Marquardt 1963). A run of the machine is what takes time: a step that promises next to
// nothing is not tried, and slopes are kept as long as steps gain about what they say by them.

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/fit/model.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct ModelFit {
  Model model;
  Eigen::VectorXd sd;  ///< of the coordinates, given the data
  double prior = 0.0;  ///< prices of the blocks and of their sizes
  double occam = 0.0;  ///< ln det of how much narrower the data make it
  double deviance = 0.0;
  double score() const { return deviance + prior + occam; }
};

using MachineWith = std::function<Machine(const Model&)>;

/// The same as long as it is not over: from then on NumericalError, which ends a fit.
MachineWith InTime(MachineWith machine_with, std::function<bool()> is_over);

/// Which values a fit may change.
enum class FittedValues {
  kAll,
  kSizes  ///< how large laws and numbers are; what shapes laws stays
};

/// When a fit ends.
struct FitEffort {
  int iterations = 0;  ///< slopes that are taken anew at most; 0: the values stay
  /// A step that promises less, in -2 ln, is not tried: a tenth of what counts (kLeastGain), and
  /// more of models that are only compared.
  double end = 0.1;
  /// What leaves more than this after three steps is not the model.
  double hopeless = std::numeric_limits<double>::infinity();
};

/// NumericalError where the run with the first values diverges; InputError where the plant
/// cannot be so.
ModelFit FitModel(const MachineWith& machine_with, const MeasuredRun& run,
                  const FilterPath& path, const KeptGains& gains,
                  const std::vector<Block>& blocks, const Model& start,
                  FitEffort effort, FittedValues fitted = FittedValues::kAll);

}  // namespace mjdiag
