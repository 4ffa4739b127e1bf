#pragma once
// The information bound (Cramer and Rao) of one run: what its readings can at most say
// of the faults, all of them unknown together, and beside them all that a diagnosis does
// not know either: the phases of disturbances, the dry friction of a nonlinear machine,
// and the state in which a record begins that was cut from the middle of a run.
//
//   Cov f^ >= I^-1,   I = P0^-1 + sum_t psi_t^T R^-1 psi_t,   psi_t = d y_t / d theta
//
// psi is that of the machine's twin where the truth is, tick by tick, along the run
// itself: with the joints that really stick. P0 knows of the start that it is no faster
// and no farther than a joule takes it, and of all else nothing.

#include <Eigen/Core>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// Standard deviations, fault parameters in the order of the plant, then disturbances.
/// @param machine     the healthy one
/// @param deviations  of the faults that are there, from healthy, in that order
/// @param record      of the whole run, which began at rest
/// @param from        first sample of it that the diagnosis sees
/// @param linear      the run is one of the linear plant
/// NumericalError if the run does not tell the faults apart.
Eigen::VectorXd RunBound(const Machine& machine, const Eigen::VectorXd& deviations,
                         const Record& record, Eigen::Index from, bool linear);

}  // namespace mjdiag
