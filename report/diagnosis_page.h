#pragma once
// The page of a diagnosis: the verdict, the residual between its thresholds, the mean
// of its magnitude, the estimates over time, and the spectrum of the disturbance
// residual over that of a healthy machine ([AB383], Fig. 17 to 24 and 32).

#include <string>

#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/report/page/run_description.h"

namespace mjdiag {

/// A row for every fault parameter, strongest first.
Table FaultTable(const DiagnosisResult& result);

/// The whole page.
Page DiagnosisPage(const DiagnosisDesign& design, const DiagnosisResult& result,
                   const MonitorLog& log, const RunDescription& run);

}  // namespace mjdiag
