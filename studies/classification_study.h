#pragma once
// The residual-based diagnosis, the twin and a data-driven diagnosis on the same runs:
// [AB383], Table 4.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Single faults of log-uniform size between [studies.table4_from] and
/// [studies.table4_to], then between [studies.table4_printed_from] and
/// [studies.table4_printed_to], and healthy runs, on the linear plant; half of the runs
/// train the support vector machines, the other half is judged by all methods.
/// `options.runs` runs in all for each of the two ranges, as many of every fault, and as
/// many healthy ones as faulty ones. The residual-based method detects by thresholds and
/// spectrum and names the fault whose estimate is most significant; the twin has to name
/// the one fault and no other. Neither is trained.
std::vector<StudyTable> ClassificationStudy(const Machine& machine,
                                            const StudyOptions& options);

}  // namespace mjdiag
