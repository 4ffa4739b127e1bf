#pragma once
// How far simulations of all records are off, before and after, and what is gained.

#include <Eigen/Core>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// Discovery::gain_train and gain_validation, from its mismatch.
void SetGains(Discovery& discovery);

/// Its mismatch, noise floor and gains, from its records.
/// @param skip  samples at the start of every record that count for nothing
void AddMismatchFigures(Eigen::Index skip, Discovery& discovery);

}  // namespace mjdiag
