#pragma once
// What a plot of a page shows. Values are in SI units; axes pick the prefix (um, mV)
// that suits the data. Samples are embedded as 32-bit floats.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mjdiag {

/// What a curve stands for; it decides the colour (Okabe-Ito, told apart without colour
/// vision) and how it is drawn, the same on every page.
enum class CurveRole { kMeasured, kSimulated, kMismatch, kNoise };

struct Curve {
  std::string label;
  CurveRole role = CurveRole::kMeasured;
  Eigen::VectorXd values;  ///< unit of the plot
};

/// A stretch of the x axis that is shaded.
struct Band {
  double from = 0.0;  ///< [s] or [Hz]
  double to = 0.0;
  std::string label;
};

/// A value of the y axis that is marked by a dashed line.
struct Level {
  double value = 0.0;  ///< unit of the plot
  std::string label;
};

/// Curves over t_k = start_time + k * sample_time.
struct TimePlot {
  std::string caption;
  std::string quantity;      ///< at the y axis, before its unit
  std::string unit;          ///< SI unit of the values
  double start_time = 0.0;   ///< [s]
  double sample_time = 0.0;  ///< [s]
  std::vector<Curve> curves;
  std::vector<Band> bands;
  std::vector<Level> levels;
  int height = 240;  ///< CSS pixels
};

/// Amplitude spectral densities over frequency, both axes logarithmic. Values that are
/// not positive are left out.
struct SpectrumPlot {
  std::string caption;
  std::string quantity;
  std::string unit;           ///< SI unit of the signal; the axis shows unit/sqrt(Hz)
  Eigen::VectorXd frequency;  ///< [Hz], increasing
  std::vector<Curve> curves;  ///< unit/sqrt(Hz)
  std::vector<Level> levels;
  int height = 240;  ///< CSS pixels
};

/// The plot as a JSON object for the page's script.
std::string DescribePlot(const TimePlot& plot);
std::string DescribePlot(const SpectrumPlot& plot);

}  // namespace mjdiag
