#pragma once
// The page of `mjdiag design`: from which degree on the machine has parity relations,
// what healthy runs leave in the residual and where its thresholds lie ([AB383],
// Fig. 15 and 16), and what the filters let through (Fig. 28 to 30).

#include <string>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/plugin/design/design_facts.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/report/page/run_description.h"

namespace mjdiag {

/// From which degree on there are parity relations, and where the residual is healthy.
std::string DesignVerdict(const DiagnosisDesign& design, const DesignFacts& facts);

/// Limits that healthy runs keep to, from and to; for a design that has them.
Table LimitTable(const DiagnosisLimits& limits);

/// One sentence on the linear programs.
std::string DescribeParityPrograms(const ParityProgramFacts& facts);

/// Bars, fitted normal distribution and thresholds of the nominal residuals.
HistogramPlot ResidualHistogram(const ThresholdDesign& thresholds);

/// The whole page; plots of the residual only where its limits are known.
Page DesignPage(const DiagnosisDesign& design, const DesignFacts& facts,
                const RunDescription& run);

}  // namespace mjdiag
