#include "mjdiag/report/diagnosis_plots.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBins = 61;
constexpr Index kFewestEstimates = 20;
// Of the bound over time: it changes as slowly as 1 / sqrt(t).
constexpr Index kBoundPoints = 60;
// From here on in percent, below in ppm.
constexpr double kLargeDeviation = 1e-2;

std::vector<Mark> Moments(const DiagnosisResult& result) {
  std::vector<Mark> marks;
  if (result.first_detection) {
    marks.push_back(
        {*result.first_detection, "residual left its thresholds at " +
                                      FormatQuantity(*result.first_detection, "s")});
  }
  if (result.lasting) {
    marks.push_back(
        {*result.lasting, "lasting from " + FormatQuantity(*result.lasting, "s")});
  }
  return marks;
}

/// Standard deviations of the estimates at some of their samples: those of a second
/// monitor over the signals of the first.
struct Bound {
  std::vector<Index> sample;  ///< of the estimates, increasing
  MatrixXd sd;                ///< nf x samples, NaN where it is not determined
};

Bound BoundOf(const DiagnosisDesign& design, const MonitorLog& log) {
  const Index estimates = log.estimates.cols();
  const auto first =
      static_cast<Index>(std::lround(log.estimate_time[0] / design.sample_time()));
  DiagnosisMonitor monitor(design);
  monitor.RegressFrom(first);
  const Index outputs = design.offset.size();
  const Index every = std::max<Index>(1, estimates / kBoundPoints);
  Bound bound;
  bound.sd = MatrixXd(log.estimates.rows(), estimates / every + 2);
  VectorXd readings(outputs);
  VectorXd commands(log.signals.rows() - outputs);
  for (Index k = 0; k < log.signals.cols(); ++k) {
    readings = log.signals.col(k).head(outputs) + design.offset;
    commands = log.signals.col(k).tail(commands.size());
    monitor.Add({readings.data(), static_cast<std::size_t>(outputs)},
                {commands.data(), static_cast<std::size_t>(commands.size())});
    const Index estimate = monitor.estimator().samples() - 1;
    const bool fresh =
        estimate >= 0 && (bound.sample.empty() || estimate > bound.sample.back());
    if (!fresh || (estimate % every != 0 && estimate != estimates - 1)) continue;
    auto sd = bound.sd.col(static_cast<Index>(bound.sample.size()));
    try {
      sd = monitor.estimator().Estimate().covariance.diagonal().cwiseSqrt();
    } catch (const NumericalError&) {
      sd.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    bound.sample.push_back(estimate);
  }
  return bound;
}

/// A row of the bound at every estimate, straight between its points.
VectorXd AtEveryEstimate(const Bound& bound, Index row, Index estimates) {
  VectorXd sd = VectorXd::Constant(estimates, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i + 1 < bound.sample.size(); ++i) {
    const Index from = bound.sample[i];
    const Index to = bound.sample[i + 1];
    const double left = bound.sd(row, static_cast<Index>(i));
    const double right = bound.sd(row, static_cast<Index>(i) + 1);
    for (Index k = from; k <= std::min(to, estimates - 1); ++k) {
      const double part =
          static_cast<double>(k - from) / static_cast<double>(to - from);
      sd[k] = left + part * (right - left);
    }
  }
  return sd;
}

/// The first estimate that is shown: after a tenth of the run, and where the bound has
/// come near to its end, within the first half. What is before would set the scale.
Index FirstShown(const VectorXd& half) {
  constexpr double kNear = 10.0;
  const Index count = half.size();
  Index first = count / 2;
  while (first > count / 10 && half[first - 1] <= kNear * half[count - 1]) --first;
  return first;
}

/// @param sd  from the noise of the sensors, of every estimate of this fault
TimePlot EstimatePlot(const DiagnosisDesign& design, const DiagnosisResult& result,
                      const MonitorLog& log, Index row, const VectorXd& sd) {
  const FaultVerdict& fault = result.faults[static_cast<std::size_t>(row)];
  VectorXd deviation(sd.size());
  VectorXd half_width(sd.size());
  for (Index k = 0; k < sd.size(); ++k) {
    const CalibratedEstimate calibrated =
        result.by_twin ? CalibratedEstimate{log.estimates(row, k), sd[k], false}
                       : Calibrate(design, row, log.estimates(row, k), sd[k]);
    deviation[k] = calibrated.deviation;
    half_width[k] = TwoSidedNormalQuantile(0.05) * calibrated.sd;
  }
  const Index first = FirstShown(half_width);
  const Index shown = sd.size() - first;
  const VectorXd half = half_width.tail(shown);
  const VectorXd estimate = deviation.tail(shown);
  const bool large = estimate.cwiseAbs().maxCoeff() > kLargeDeviation;
  const double factor = large ? 1e2 : 1e6;
  TimePlot plot;
  plot.caption = fault.name + ", estimate from healthy";
  plot.quantity = fault.name;
  plot.unit = large ? "%" : "ppm";
  plot.scaled = false;
  plot.start_time = log.estimate_time[first];
  plot.sample_time = design.decimation * design.sample_time();
  plot.curves = {{"estimate", CurveRole::kMeasured, factor * estimate},
                 {"bound, +1.96 sd", CurveRole::kNoise, factor * half},
                 {"bound, -1.96 sd", CurveRole::kNoise, -factor * half}};
  plot.levels = {{factor * fault.deviation, "final estimate"}};
  for (const Mark& mark : Moments(result)) {
    if (mark.value >= plot.start_time) plot.marks.push_back(mark);
  }
  plot.height = 180;
  return plot;
}

}  // namespace

TimePlot ResidualPlot(const DiagnosisResult& result, const MonitorLog& log) {
  TimePlot plot;
  plot.caption = "Residual and its thresholds";
  plot.quantity = "residual";
  plot.unit = "1";
  plot.sample_time = result.sample_time;
  plot.curves = {{"residual", CurveRole::kMismatch, log.residual}};
  plot.levels = {{result.limits.min, "threshold"}, {result.limits.max, "threshold"}};
  plot.marks = Moments(result);
  return plot;
}

TimePlot IntegralPlot(const DiagnosisDesign& design, const DiagnosisResult& result,
                      const MonitorLog& log) {
  TimePlot plot;
  plot.caption = "Mean magnitude of the residual over " +
                 FormatQuantity(design.options.integral_window, "s");
  plot.quantity = "mean";
  plot.unit = "1";
  plot.sample_time = result.sample_time;
  plot.curves = {{"mean of |residual|", CurveRole::kMismatch, log.integral}};
  plot.levels = {{design.limits.integral, "threshold"}};
  plot.marks = Moments(result);
  plot.height = 160;
  return plot;
}

HistogramPlot RunHistogram(const DiagnosisDesign& design, const DiagnosisResult& result,
                           const MonitorLog& log) {
  HistogramPlot plot;
  plot.caption = "Histogram of the residual";
  plot.quantity = "residual";
  plot.unit = "1";
  plot.counted = "samples";
  plot.label = "this run";
  const double low = std::min(log.residual.minCoeff(), result.limits.min);
  const double high = std::max(log.residual.maxCoeff(), result.limits.max);
  plot.edges = VectorXd::LinSpaced(kBins + 1, low, high);
  plot.counts = VectorXd::Zero(kBins);
  const double width = (high - low) / static_cast<double>(kBins);
  for (const double value : log.residual) {
    const auto bin = width > 0.0 ? static_cast<Index>((value - low) / width) : 0;
    plot.counts[std::min(bin, kBins - 1)] += 1.0;
  }
  plot.marks = {{result.limits.min, "threshold"}, {result.limits.max, "threshold"}};
  const NormalFit& fit = design.limits.residual.fit;
  if (!design.limits.known || !(fit.sd > 0.0)) return plot;
  // Its own samples: in bins of a large residual it is a spike.
  const VectorXd x =
      VectorXd::LinSpaced(201, fit.mean - 4.0 * fit.sd, fit.mean + 4.0 * fit.sd);
  const VectorXd density = NormalDensity(x, fit.mean, fit.sd);
  // A bin wider than the distribution holds all of it.
  const auto samples = static_cast<double>(log.residual.size());
  plot.curves = {{"healthy runs, normal distribution", CurveRole::kSimulated, x,
                  (samples * width * density).cwiseMin(samples)}};
  return plot;
}

SpectrumPlot DisturbanceSpectrum(const DiagnosisDesign& design,
                                 const DiagnosisResult& result) {
  const Spectrum& spectrum = result.disturbance.spectrum;
  const Spectrum& nominal = design.limits.disturbance.nominal;
  SpectrumPlot plot;
  plot.caption = "Spectrum of the disturbance residual";
  plot.quantity = "residual";
  plot.unit = "1";
  plot.frequency = spectrum.frequency;
  plot.curves = {{"this run", CurveRole::kMismatch, spectrum.density.cwiseSqrt()}};
  if (nominal.density.size() == spectrum.density.size()) {
    plot.curves.push_back(
        {"healthy machine", CurveRole::kNoise, nominal.density.cwiseSqrt()});
  }
  for (const DisturbanceTone& tone : result.disturbance.tones) {
    plot.marks.push_back({tone.frequency, FormatQuantity(tone.frequency, "Hz")});
  }
  return plot;
}

std::vector<TimePlot> EstimatePlots(const DiagnosisDesign& design,
                                    const DiagnosisResult& result,
                                    const MonitorLog& log) {
  std::vector<TimePlot> plots;
  const Index count = log.estimates.cols();
  if (count < kFewestEstimates) return plots;
  const Bound bound = result.by_twin ? Bound{} : BoundOf(design, log);
  for (std::size_t i = 0; i < result.faults.size(); ++i) {
    const auto row = static_cast<Index>(i);
    plots.push_back(EstimatePlot(design, result, log, row,
                                 result.by_twin ? VectorXd(log.estimate_sd.row(row))
                                                : AtEveryEstimate(bound, row, count)));
  }
  return plots;
}

}  // namespace mjdiag
