#pragma once
// How small a fault is seen: [AB383], Tables 2, 3 and 5, by the residuals of the thesis
// and by the twin side by side. A fault counts as seen at a size at which 95 % of the seeds
// see it (`seeds`, or as many as the plan has replications, if that is less); false alarms
// are counted in as many healthy runs as replications, at the same setting. Faults are those
// of the case "largest", in the direction of the value there, which is also the largest
// that is tried; those of the case "published" are compared with. Seeds and noise differ
// from those of the design.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// By every judge: on the linear plant with the limits of the setup from nominal runs, on
/// the nonlinear one from nominal runs of the motion; `baseline` subtracts the residuals'
/// baseline of the same motion. The robust residual of a fault looks for that one alone.
std::vector<StudyTable> AnswerTo(const AskSmallestSize& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
