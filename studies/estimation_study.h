#pragma once
// How well all faults are estimated when they are present at once: [AB383],
// section 5.5, with intervals whose coverage is counted.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// For the sizes under [studies.estimation_large], [studies.estimation_small] and
/// [studies.estimation_faint], all faults of a table present at once on the linear plant,
/// and for the healthy one: mean estimate over `options.runs` runs, largest error as a
/// share of the deviation, standard deviation claimed and found, how often the 95 %
/// interval held the truth with the binomial 99 % band of that count, and the multiple of
/// the information bound. Every fault parameter and disturbance is estimated, by the twin
/// of the machine (twin_estimator.h).
std::vector<StudyTable> EstimationStudy(const Machine& machine,
                                        const StudyOptions& options);

}  // namespace mjdiag
