#pragma once
// How small a fault is seen: [AB383], Tables 2, 3 and 5, by the residuals of the thesis
// and by the twin side by side. A fault counts as seen at a size at which 95 % of 40
// seeds see it (of `options.runs`, if that is less); false alarms are counted in
// `options.runs` healthy runs at the same setting. Faults are those under
// [studies.largest], in the direction of the value there, which is also the largest that
// is tried; seeds and noise differ from those of the design.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Table 2, linear plant, default trajectory, sizes of the thesis under [studies.table2]:
/// residual, spectrum, estimate from residuals, and twin; delays of the residual at those
/// sizes beside them.
std::vector<StudyTable> LinearDetectionStudy(const Machine& machine,
                                             const StudyOptions& options);

/// Table 3 (`study` "table3", limits from nominal runs of the nonlinear plant) or Table 5
/// ("table5", the residuals' baseline of the same motion subtracted): residual, the one
/// made robust for that fault, spectrum, estimate from residuals, and in Table 3 the twin,
/// which would be the same in both.
std::vector<StudyTable> NonlinearDetectionStudy(const Machine& machine,
                                                const std::string& study, bool baseline,
                                                const StudyOptions& options);

}  // namespace mjdiag
