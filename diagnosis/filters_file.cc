#include "mjdiag/diagnosis/filters_file.h"

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "mjdiag/diagnosis/json_matrix.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using nlohmann::json;

constexpr const char* kSchema = "mjdiag.filters/1";

json Json(const FilterBank& bank) {
  return {{"gain", bank.gain},
          {"feedback", VectorJson(bank.feedback)},
          {"B", MatrixJson(bank.B)},
          {"D", MatrixJson(bank.D)}};
}

FilterBank Bank(const json& object, double sample_time) {
  return {sample_time, VectorOf(object.at("feedback")), object.at("gain").get<double>(),
          MatrixOf(object.at("B")), MatrixOf(object.at("D"))};
}

json Json(const Interval& interval) { return {interval.min, interval.max}; }
Interval ToInterval(const json& pair) {
  return {pair.at(0).get<double>(), pair.at(1).get<double>()};
}

json Json(const Multisine& source) {
  return {{"name", source.name},
          {"frequencies", source.frequencies},
          {"amplitude", VectorJson(source.amplitude)}};
}

json Json(const DisturbanceFilter& filter) {
  json sections = json::array();
  for (const SecondOrderSection& s : filter.high_pass) {
    sections.push_back({s.b0, s.b1, s.b2, s.a1, s.a2});
  }
  return {{"filters", Json(filter.filter)},
          {"prefilters", Json(filter.prefilters)},
          {"high_pass", sections}};
}

DisturbanceFilter ToDisturbanceFilter(const json& object, double sample_time) {
  DisturbanceFilter filter{Bank(object.at("filters"), sample_time),
                           Bank(object.at("prefilters"), sample_time),
                           {}};
  for (const json& s : object.at("high_pass")) {
    const auto c = s.get<std::array<double, 5>>();
    filter.high_pass.push_back({c[0], c[1], c[2], c[3], c[4]});
  }
  return filter;
}

json Json(const DisturbanceOptions& options) {
  return {{"segment", options.segment},
          {"low", options.low},
          {"high", std::isfinite(options.high) ? json(options.high) : json()},
          {"peak_margin", options.peak_margin},
          {"total_margin", options.total_margin},
          {"tone_false_alarm", options.tone_false_alarm}};
}

DisturbanceOptions ToDisturbanceOptions(const json& object) {
  DisturbanceOptions options;
  options.segment = WholeOf(object.at("segment"));
  options.low = object.at("low");
  if (!object.at("high").is_null()) options.high = object.at("high");
  options.peak_margin = object.at("peak_margin");
  options.total_margin = object.at("total_margin");
  options.tone_false_alarm = object.at("tone_false_alarm");
  return options;
}

json Json(const DisturbanceThresholds& limits) {
  return {{"segment", limits.segment},
          {"peak", limits.peak},
          {"total", limits.total},
          {"noise_ratio", limits.noise_ratio},
          {"broadband", limits.broadband},
          {"frequency", VectorJson(limits.nominal.frequency)},
          {"nominal", VectorJson(limits.nominal.density)},
          {"highest", VectorJson(limits.highest)},
          {"nominal_dof", limits.nominal_dof}};
}

DisturbanceThresholds ToDisturbanceThresholds(const json& object) {
  DisturbanceThresholds limits;
  limits.segment = WholeOf(object.at("segment"));
  limits.peak = object.at("peak");
  limits.total = object.at("total");
  limits.noise_ratio = object.at("noise_ratio");
  limits.broadband = object.at("broadband");
  limits.nominal = {VectorOf(object.at("frequency")), VectorOf(object.at("nominal"))};
  limits.highest = VectorOf(object.at("highest"));
  limits.nominal_dof = object.at("nominal_dof");
  return limits;
}

json Json(const DiagnosisLimits& limits) {
  json estimates = json::array();
  for (const Interval& interval : limits.estimates) estimates.push_back(Json(interval));
  const ThresholdDesign& residual = limits.residual;
  return {{"residual", Json(residual.limits)},
          {"alpha", residual.alpha},
          {"fit", {{"mean", residual.fit.mean}, {"sd", residual.fit.sd}}},
          {"histogram",
           {{"edges", residual.histogram.edges}, {"count", residual.histogram.count}}},
          {"integral", limits.integral},
          {"estimates", estimates},
          {"disturbance", Json(limits.disturbance)}};
}

DiagnosisLimits ToLimits(const json& object) {
  DiagnosisLimits limits;
  limits.residual.limits = ToInterval(object.at("residual"));
  limits.residual.alpha = object.at("alpha");
  limits.residual.fit = {object.at("fit").at("mean"), object.at("fit").at("sd")};
  limits.residual.histogram.edges =
      object.at("histogram").at("edges").get<std::vector<double>>();
  for (const json& count : object.at("histogram").at("count")) {
    limits.residual.histogram.count.push_back(WholeOf(count));
  }
  limits.integral = object.at("integral");
  for (const json& pair : object.at("estimates")) {
    limits.estimates.push_back(ToInterval(pair));
  }
  limits.disturbance = ToDisturbanceThresholds(object.at("disturbance"));
  limits.known = true;
  return limits;
}

DiagnosisDesign Parse(const json& object) {
  DiagnosisDesign design;
  const double sample_time = object.at("sample_time");
  design.setup = object.at("setup");
  design.linear = object.value("linear", false);
  design.outputs = object.at("outputs").get<std::vector<std::string>>();
  design.inputs = object.at("inputs").get<std::vector<std::string>>();
  design.offset = VectorOf(object.at("offset"));
  design.sensor_noise = VectorOf(object.at("sensor_noise"));
  design.bank.residuals = WholeOf(object.at("residuals"));
  design.bank.faults = object.at("faults").get<std::vector<std::string>>();
  design.bank.filters = Bank(object.at("filters"), sample_time);
  for (const json& rows : object.at("rows"))
    design.bank.relations.push_back(MatrixOf(rows));
  for (const json& source : object.at("disturbances")) {
    design.disturbances.push_back({source.at("name"),
                                   source.at("frequencies").get<std::vector<double>>(),
                                   VectorOf(source.at("amplitude"))});
  }
  design.disturbance = ToDisturbanceFilter(object.at("disturbance"), sample_time);
  design.decimation = WholeOf<int>(object.at("stride"));
  const json& options = object.at("options");
  design.options.integral_window = options.at("integral_window");
  design.options.forgetting = options.at("forgetting");
  design.options.horizon = options.at("horizon");
  design.options.disturbance = ToDisturbanceOptions(options.at("disturbance"));
  if (!object.at("limits").is_null()) design.limits = ToLimits(object.at("limits"));
  return design;
}

void RequireShapes(const std::string& file, const DiagnosisDesign& design) {
  const FilterBank& bank = design.bank.filters;
  const auto ny = static_cast<Index>(design.outputs.size());
  const Index nz = ny + static_cast<Index>(design.inputs.size());
  const Index m =
      design.bank.residuals * (1 + static_cast<Index>(design.bank.faults.size()));
  const FilterBank& other = design.disturbance.filter;
  const FilterBank& prefilters = design.disturbance.prefilters;
  const bool fits =
      design.bank.residuals > 0 && bank.D.rows() == m && bank.D.cols() == nz &&
      bank.B.rows() == m * bank.order() && bank.B.cols() == nz &&
      design.offset.size() == ny && design.sensor_noise.size() == ny &&
      other.D.cols() == nz && other.B.rows() == other.D.rows() * other.order() &&
      other.D.rows() == 1 &&
      prefilters.D.rows() == static_cast<Index>(design.bank.faults.size()) &&
      prefilters.B.rows() == prefilters.D.rows() * prefilters.order() &&
      prefilters.B.cols() == prefilters.D.cols() &&
      (design.limits.estimates.empty() ||
       std::ssize(design.limits.estimates) == design.faults()) &&
      design.decimation > 0 && bank.sample_time > 0.0;
  if (!fits) {
    throw InputError(file, "shapes of filters, channels and faults do not fit",
                     "a file that `mjdiag design` wrote");
  }
  // Work that grows with it is done before the first sample.
  constexpr double kLongestStride = 100.0;  // s
  if (design.decimation * bank.sample_time > kLongestStride) {
    throw InputError(file,
                     "stride of " + std::to_string(design.decimation) + " samples",
                     "at most 100 s");
  }
}

json Json(const DiagnosisDesign& design) {
  json disturbances = json::array();
  for (const Multisine& source : design.disturbances)
    disturbances.push_back(Json(source));
  json rows = json::array();
  for (const MatrixXd& coefficient : design.bank.relations)
    rows.push_back(MatrixJson(coefficient));
  return {{"schema", kSchema},
          {"setup", design.setup},
          {"linear", design.linear},
          {"sample_time", design.sample_time()},
          {"outputs", design.outputs},
          {"inputs", design.inputs},
          {"offset", VectorJson(design.offset)},
          {"sensor_noise", VectorJson(design.sensor_noise)},
          {"residuals", design.bank.residuals},
          {"faults", design.bank.faults},
          {"filters", Json(design.bank.filters)},
          {"rows", rows},
          {"disturbances", disturbances},
          {"disturbance", Json(design.disturbance)},
          {"stride", design.decimation},
          {"options",
           {{"integral_window", design.options.integral_window},
            {"forgetting", design.options.forgetting},
            {"horizon", design.options.horizon},
            {"disturbance", Json(design.options.disturbance)}}},
          {"limits", design.limits.known ? Json(design.limits) : json()}};
}

}  // namespace

std::string FiltersJson(const DiagnosisDesign& design) {
  return Json(design).dump(2, ' ', false, json::error_handler_t::replace);
}

void WriteFilters(const std::filesystem::path& file, const DiagnosisDesign& design) {
  WriteTextFile(file, FiltersJson(design) + "\n");
}

DiagnosisDesign ReadFilters(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw InputError(file.string(), "cannot be read", "a file of `mjdiag design`");
  }
  try {
    const json document = json::parse(stream);
    if (document.value("schema", "") != kSchema) {
      throw InputError(file.string(), "has no schema \"" + std::string(kSchema) + "\"",
                       "a file of `mjdiag design`");
    }
    DiagnosisDesign design = Parse(document);
    RequireShapes(file.string(), design);
    return design;
  } catch (const json::exception& error) {
    throw InputError(file.string(), error.what(), "a file of `mjdiag design`");
  }
}

}  // namespace mjdiag
