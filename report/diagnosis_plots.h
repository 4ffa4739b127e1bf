#pragma once
// The plots of a diagnosis: the residual between its thresholds, over time and counted,
// the mean of its magnitude, the spectrum of the disturbance residual with its tones,
// and the estimates over time ([AB383], Fig. 17 to 24 and 32).

#include <vector>

#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/report/page/plot.h"

namespace mjdiag {

/// Time plots mark the moments of detection.
TimePlot ResidualPlot(const DiagnosisResult& result, const MonitorLog& log);
TimePlot IntegralPlot(const DiagnosisDesign& design, const DiagnosisResult& result,
                      const MonitorLog& log);

/// The residual counted, with what the normal distribution of healthy runs would give.
HistogramPlot RunHistogram(const DiagnosisDesign& design, const DiagnosisResult& result,
                           const MonitorLog& log);

/// With the nominal spectrum and the tones by their frequency.
SpectrumPlot DisturbanceSpectrum(const DiagnosisDesign& design,
                                 const DiagnosisResult& result);

/// The running estimate of every fault from healthy in ppm or percent, without the
/// beginning, which has too little data behind it and would set the scale, and the
/// bound +-1.96 sd inside which 95 of 100 estimates of a healthy machine stay: sensor
/// noise, and how far healthy runs differ. No plots if there are too few estimates.
std::vector<TimePlot> EstimatePlots(const DiagnosisDesign& design,
                                    const DiagnosisResult& result,
                                    const MonitorLog& log);

}  // namespace mjdiag
