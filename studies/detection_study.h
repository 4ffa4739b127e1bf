#pragma once
// How small a fault is seen: [AB383], Tables 2, 3 and 5.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Table 2, linear plant, both controllers, default trajectory. Of every fault under
/// [studies.largest]: whether its size under [studies.table2] leaves the thresholds,
/// and when; the smallest size that does, by bisection; the smallest that the estimate
/// and the spectrum see; and the information bound. Beside it the false alarms in
/// `options.runs` healthy runs. Both seeds and noise differ from those of the design.
std::vector<StudyTable> LinearDetectionStudy(const Machine& machine,
                                             const StudyOptions& options);

/// Table 3 (`study` "table3", thresholds from nominal runs of the nonlinear plant) or
/// Table 5 ("table5", with the baseline of the same motion subtracted): every fault at
/// the published size and the smallest size seen, by the residual for all faults, by
/// the residual made robust for that fault, and by the estimate with its limits from
/// nominal runs.
std::vector<StudyTable> NonlinearDetectionStudy(const Machine& machine,
                                                const std::string& study, bool baseline,
                                                const StudyOptions& options);

}  // namespace mjdiag
