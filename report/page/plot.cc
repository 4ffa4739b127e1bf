#include <algorithm>
#include <bit>
#include <cmath>

#include "mjdiag/report/page/base64.h"
#include "mjdiag/report/page/plot_json.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pages hold little-endian samples");

std::string EncodeSamples(const Eigen::VectorXd& values) {
  const Eigen::VectorXf samples = values.cast<float>();
  return Base64({reinterpret_cast<const char*>(samples.data()),
                 static_cast<std::size_t>(samples.size()) * sizeof(float)});
}

const char* RoleName(CurveRole role) {
  switch (role) {
    case CurveRole::kMeasured:
      return "measured";
    case CurveRole::kSimulated:
      return "simulated";
    case CurveRole::kMismatch:
      return "mismatch";
    case CurveRole::kNoise:
      return "noise";
  }
  return "";
}

/// The largest finite magnitude; 0 if there is none.
double LargestMagnitude(const Eigen::VectorXd& values) {
  double largest = 0.0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

double LargestMagnitude(const std::vector<Curve>& curves) {
  double largest = 0.0;
  for (const Curve& curve : curves) {
    largest = std::max(largest, LargestMagnitude(curve.values));
  }
  return largest;
}

void RequireSize(const std::string& caption, const std::string& what,
                 Eigen::Index found, Eigen::Index expected) {
  if (found == expected) return;
  throw InputError("plot '" + caption + "'", what + ": " + std::to_string(found),
                   std::to_string(expected));
}

std::string AxisLabel(const std::string& quantity, const std::string& unit) {
  return unit.empty() ? quantity : quantity + " [" + unit + "]";
}

nlohmann::json CurvesAndLevels(const std::vector<Curve>& curves,
                               const std::vector<Level>& levels, double factor) {
  nlohmann::json plot;
  plot["curves"] = nlohmann::json::array();
  for (const Curve& curve : curves) {
    plot["curves"].push_back({{"label", curve.label},
                              {"role", RoleName(curve.role)},
                              {"samples", EncodeSamples(factor * curve.values)}});
  }
  plot["levels"] = nlohmann::json::array();
  for (const Level& level : levels) {
    plot["levels"].push_back({{"value", factor * level.value}, {"label", level.label}});
  }
  return plot;
}

/// Points or curves of (x, y), each in the unit in which it is shown.
template <typename Series>
nlohmann::json SeriesJson(const std::string& caption,
                          const std::vector<Series>& all_series, double x_factor,
                          double y_factor) {
  nlohmann::json list = nlohmann::json::array();
  for (const Series& series : all_series) {
    RequireSize(caption, "values of y of '" + series.label + "'", series.y.size(),
                series.x.size());
    list.push_back({{"label", series.label},
                    {"role", RoleName(series.role)},
                    {"x", EncodeSamples(x_factor * series.x)},
                    {"y", EncodeSamples(y_factor * series.y)}});
  }
  return list;
}

nlohmann::json MarksJson(const std::vector<Mark>& marks, double factor) {
  nlohmann::json list = nlohmann::json::array();
  for (const Mark& mark : marks) {
    list.push_back({{"value", factor * mark.value}, {"label", mark.label}});
  }
  return list;
}

/// The colours of the page's palette; curves beyond them begin again.
constexpr std::size_t kPaletteSize = 6;

}  // namespace

nlohmann::json DescribePlot(const TimePlot& plot) {
  const DisplayUnit unit =
      plot.scaled ? ChooseDisplayUnit(LargestMagnitude(plot.curves), plot.unit)
                  : DisplayUnit{1.0, plot.unit};
  nlohmann::json json = CurvesAndLevels(plot.curves, plot.levels, unit.factor);
  json["kind"] = "time";
  json["x_label"] = "time [s]";
  json["y_label"] = AxisLabel(plot.quantity, unit.name);
  json["unit"] = unit.name;
  json["start"] = plot.start_time;
  json["step"] = plot.sample_time;
  json["height"] = plot.height;
  json["marks"] = MarksJson(plot.marks, 1.0);
  json["bands"] = nlohmann::json::array();
  for (const Band& band : plot.bands) {
    json["bands"].push_back(
        {{"from", band.from}, {"to", band.to}, {"label", band.label}});
  }
  return json;
}

nlohmann::json DescribePlot(const SpectrumPlot& plot) {
  const DisplayUnit unit = ChooseDisplayUnit(LargestMagnitude(plot.curves), plot.unit);
  nlohmann::json json = CurvesAndLevels(plot.curves, plot.levels, unit.factor);
  json["kind"] = "spectrum";
  json["x_label"] = "frequency [Hz]";
  const std::string density = (unit.name.empty() ? "1" : unit.name) + "/√Hz";
  json["y_label"] = AxisLabel(plot.quantity, density);
  json["unit"] = density;
  json["frequency"] = EncodeSamples(plot.frequency);
  json["height"] = plot.height;
  json["marks"] = MarksJson(plot.marks, 1.0);
  json["bands"] = nlohmann::json::array();
  return json;
}

nlohmann::json DescribePlot(const XyPlot& plot) {
  double x_magnitude = 0.0;
  double y_magnitude = 0.0;
  const auto include = [&](const auto& all_series) {
    for (const auto& series : all_series) {
      x_magnitude = std::max(x_magnitude, LargestMagnitude(series.x));
      y_magnitude = std::max(y_magnitude, LargestMagnitude(series.y));
    }
  };
  include(plot.points);
  include(plot.curves);
  const DisplayUnit x = ChooseDisplayUnit(x_magnitude, plot.x_unit);
  const DisplayUnit y = ChooseDisplayUnit(y_magnitude, plot.y_unit);
  return nlohmann::json{
      {"kind", "xy"},
      {"x_label", AxisLabel(plot.x_quantity, x.name)},
      {"y_label", AxisLabel(plot.y_quantity, y.name)},
      {"height", plot.height},
      {"points", SeriesJson(plot.caption, plot.points, x.factor, y.factor)},
      {"curves", SeriesJson(plot.caption, plot.curves, x.factor, y.factor)}};
}

nlohmann::json DescribePlot(const HistogramPlot& plot) {
  RequireSize(plot.caption, "edges", plot.edges.size(), plot.counts.size() + 1);
  const DisplayUnit unit = ChooseDisplayUnit(LargestMagnitude(plot.edges), plot.unit);
  return nlohmann::json{
      {"kind", "histogram"},
      {"x_label", AxisLabel(plot.quantity, unit.name)},
      {"y_label", plot.counted},
      {"height", plot.height},
      {"bars",
       {{"label", plot.label},
        {"edges", EncodeSamples(unit.factor * plot.edges)},
        {"counts", EncodeSamples(plot.counts)}}},
      {"curves", SeriesJson(plot.caption, plot.curves, unit.factor, 1.0)},
      {"marks", MarksJson(plot.marks, unit.factor)}};
}

nlohmann::json DescribePlot(const BodePlot& plot) {
  nlohmann::json curves = nlohmann::json::array();
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    const BodeCurve& curve = plot.curves[i];
    RequireSize(plot.caption, "magnitudes of '" + curve.label + "'",
                curve.magnitude.size(), plot.frequency.size());
    // What is not positive becomes NaN or minus infinity, which the page leaves out.
    const Eigen::VectorXd decibels = 20.0 * curve.magnitude.array().log10();
    curves.push_back({{"label", curve.label},
                      {"role", "palette" + std::to_string(i % kPaletteSize)},
                      {"samples", EncodeSamples(decibels)}});
  }
  return nlohmann::json{
      {"kind", "bode"},
      {"x_label", "frequency [Hz]"},
      {"y_label",
       plot.quantity + (plot.unit.empty() ? " [dB]" : " [dB re " + plot.unit + "]")},
      {"unit", "dB"},
      {"frequency", EncodeSamples(plot.frequency)},
      {"height", plot.height},
      {"curves", curves},
      {"marks", MarksJson(plot.marks, 1.0)}};
}

}  // namespace mjdiag
