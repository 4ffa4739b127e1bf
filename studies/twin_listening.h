#pragma once
// What a machine's twin makes of a record.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/studies/machine_study.h"

namespace mjdiag {

/// What the twin of the healthy machine says that has listened to the whole record.
TwinReading Listen(const Machine& machine, const Record& record, bool linear);

/// Deviations from healthy in the order of the names; 0 of what is not among the faults.
Eigen::VectorXd DeviationsOf(const Setup& setup, const std::vector<std::string>& names,
                             const std::vector<SizedFault>& faults);

}  // namespace mjdiag
