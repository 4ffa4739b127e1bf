#pragma once
// What large faults put into the estimates. Prefilters are made about the healthy
// machine, so a deviation d of one fault parameter leaves errors of the order d^2 in
// all estimates, small beside d but many times their own noise. They are found by
// simulation: with D(f) the estimate of a run of the plant with the faults f, less that
// of the healthy plant in the same noise,
//
//   D_i(f) = d_i         for the faults i that are named (Broyden's method),
//   d_j - D_j(f)         is what is left of the others,
//
// where d is the estimate that was diagnosed. The strongest fault is named first, and
// then the strongest of what is left, until nothing is.

#include <Eigen/Core>

#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/plugin/design/filter_design.h"

namespace mjdiag {

/// What was diagnosed, and how a plant is diagnosed in the same way.
struct DiagnosedMotion {
  const Excitation& excitation;
  const Eigen::MatrixXd& baseline;   ///< subtracted from its residuals; may be empty
  Eigen::Index first_regressed = 0;  ///< sample
  const NominalRuns& runs;           ///< whether the plant is linearised, and the seed
};

/// Takes cross terms out of detected faults: those that are nothing else become
/// `cross_term` and are no longer `detected`, the others have the value f. Nothing
/// changes where no such f is found.
void RemoveCrossTerms(DiagnosisResult& result, const DiagnosisDesign& design,
                      const Machine& machine, const DiagnosedMotion& motion);

}  // namespace mjdiag
