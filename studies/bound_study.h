#pragma once
// The information bound of every fault, and what the estimators make of it.

#include "mjdiag/diagnosis/residuals/cramer_rao.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Cramer-Rao bound of all fault parameters and disturbances for a motion of the
/// healthy linear plant: fault parameters in the order of the plant, then the setup's
/// disturbances.
InformationBound FaultBound(const Machine& machine, const Excitation& motion);

/// The same for a machine with faults, all unknown together, and nobody knows the phases
/// of the tones of a disturbance: that of a magnitude is what all of its tones say.
/// @param deviations  from healthy, in that order
/// @return standard deviations
Eigen::VectorXd FaultBoundAt(const Machine& machine, const Excitation& motion,
                             const Eigen::VectorXd& deviations);

/// That of the magnitude that all tones of a disturbance have in common, from those of
/// the sine and the cosine of each.
double MagnitudeBound(const Eigen::VectorXd& parts);

/// Place of a fault in that order; InputError on an unknown one.
std::ptrdiff_t BoundIndex(const Machine& machine, const std::string& fault);

}  // namespace mjdiag
