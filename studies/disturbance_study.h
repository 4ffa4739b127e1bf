#pragma once
// Tones and noise in the disturbance residual: [AB383], section 5.6.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Linear plant, default trajectory: every disturbance of the setup at 1 % and 0.1 % of
/// its magnitude, healthy runs, and tenfold sensor noise; tones found with their
/// frequencies, the magnitude estimated, and whether noise was called raised, each over
/// `options.runs` runs.
std::vector<StudyTable> DisturbanceStudy(const Machine& machine,
                                         const StudyOptions& options);

}  // namespace mjdiag
