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

/// A value of the x axis that is marked by a dashed line.
struct Mark {
  double value = 0.0;  ///< unit of the x axis
  std::string label;
};

/// Curves over t_k = start_time + k * sample_time.
struct TimePlot {
  std::string caption;
  std::string quantity;      ///< at the y axis, before its unit
  std::string unit;          ///< SI unit of the values
  bool scaled = true;        ///< with the prefix that suits; false: the unit as it is
  double start_time = 0.0;   ///< [s]
  double sample_time = 0.0;  ///< [s]
  std::vector<Curve> curves;
  std::vector<Band> bands;
  std::vector<Level> levels;
  std::vector<Mark> marks;  ///< [s], for example the moment of detection
  int height = 240;         ///< CSS pixels
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
  std::vector<Mark> marks;  ///< [Hz], named where they stand, for example peaks
  int height = 240;         ///< CSS pixels
};

/// Measured pairs, drawn as dots.
struct XyPoints {
  std::string label;
  CurveRole role = CurveRole::kMeasured;
  Eigen::VectorXd x;  ///< unit of the x axis
  Eigen::VectorXd y;  ///< as many, unit of the y axis
};

/// A line through (x, y) in their order, which need not be that of x: loops are drawn
/// as loops. It breaks where a value is not finite.
struct XyCurve {
  std::string label;
  CurveRole role = CurveRole::kSimulated;
  Eigen::VectorXd x;  ///< unit of the x axis
  Eigen::VectorXd y;  ///< as many, unit of the y axis
};

/// One quantity over another, for example a force over a velocity: points, and lines
/// over them.
struct XyPlot {
  std::string caption;
  std::string x_quantity;
  std::string x_unit;  ///< SI unit of x
  std::string y_quantity;
  std::string y_unit;  ///< SI unit of y
  std::vector<XyPoints> points;
  std::vector<XyCurve> curves;
  int height = 320;  ///< CSS pixels
};

/// Counts of a quantity in bins, lines over them (a fitted distribution in counts), and
/// marks (thresholds).
struct HistogramPlot {
  std::string caption;
  std::string quantity;
  std::string unit;        ///< SI unit of the quantity
  std::string counted;     ///< at the y axis, for example "samples"
  std::string label;       ///< of the bars
  Eigen::VectorXd edges;   ///< bins + 1, increasing, unit of the quantity
  Eigen::VectorXd counts;  ///< bins
  std::vector<XyCurve> curves;
  std::vector<Mark> marks;
  int height = 280;  ///< CSS pixels
};

struct BodeCurve {
  std::string label;
  Eigen::VectorXd magnitude;  ///< |H|, one for each frequency
};

/// Magnitudes in dB, 20 log10 |H|, over logarithmic frequency. Curves take the colours
/// of the palette in their order. Magnitudes that are not positive are left out.
struct BodePlot {
  std::string caption;
  std::string quantity;
  std::string unit;           ///< of the magnitude, 0 dB is one of it; empty: a number
  Eigen::VectorXd frequency;  ///< [Hz], increasing
  std::vector<BodeCurve> curves;
  std::vector<Mark> marks;  ///< [Hz], for example cut-offs
  int height = 280;         ///< CSS pixels
};

}  // namespace mjdiag
