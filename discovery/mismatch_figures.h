#pragma once
// How far simulations of all records are off, before and after, and what is gained.

#include <Eigen/Core>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Discovery::gain_train and gain_validation, from its mismatch.
void SetGains(Discovery& discovery);

/// Its mismatch, noise floor and gains, from its records.
/// @param first    sample from which they count
/// @param train    of a single record, how many fits saw
/// @param samples  of what fits saw, so many count; 0: all
void AddMismatchFigures(Eigen::Index first, Eigen::Index train, Eigen::Index samples,
                        Discovery& discovery);

}  // namespace mjdiag
