#include "mjdiag/report/plot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pages hold little-endian samples");

std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const std::uint32_t byte =
          j < count ? static_cast<unsigned char>(bytes[i + j]) : 0U;
      word = word << 8 | byte;
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += j <= count ? kDigits[word >> (18 - 6 * j) & 63U] : '=';
    }
  }
  return text;
}

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

/// The largest finite magnitude that the curves show.
double Magnitude(const std::vector<Curve>& curves) {
  double largest = 0.0;
  for (const Curve& curve : curves) {
    for (const double value : curve.values) {
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
  }
  return largest;
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

}  // namespace

std::string DescribePlot(const TimePlot& plot) {
  const DisplayUnit unit = ChooseDisplayUnit(Magnitude(plot.curves), plot.unit);
  nlohmann::json json = CurvesAndLevels(plot.curves, plot.levels, unit.factor);
  json["kind"] = "time";
  json["x_label"] = "time [s]";
  json["y_label"] = AxisLabel(plot.quantity, unit.name);
  json["unit"] = unit.name;
  json["start"] = plot.start_time;
  json["step"] = plot.sample_time;
  json["height"] = plot.height;
  json["bands"] = nlohmann::json::array();
  for (const Band& band : plot.bands) {
    json["bands"].push_back(
        {{"from", band.from}, {"to", band.to}, {"label", band.label}});
  }
  return json.dump();
}

std::string DescribePlot(const SpectrumPlot& plot) {
  const DisplayUnit unit = ChooseDisplayUnit(Magnitude(plot.curves), plot.unit);
  nlohmann::json json = CurvesAndLevels(plot.curves, plot.levels, unit.factor);
  json["kind"] = "spectrum";
  json["x_label"] = "frequency [Hz]";
  const std::string density = (unit.name.empty() ? "1" : unit.name) + "/√Hz";
  json["y_label"] = AxisLabel(plot.quantity, density);
  json["unit"] = density;
  json["frequency"] = EncodeSamples(plot.frequency);
  json["height"] = plot.height;
  json["bands"] = nlohmann::json::array();
  return json.dump();
}

}  // namespace mjdiag
