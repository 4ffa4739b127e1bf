#include "mjdiag/plugin/setup/calibration_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "mjdiag/diagnosis/json_matrix.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using nlohmann::json;

constexpr const char* kCalibrationSchema = "mjdiag.calibration/1";

void Require(bool fulfilled, const std::filesystem::path& file, const char* what,
             const char* expected) {
  if (!fulfilled) throw InputError(file.string(), what, expected);
}

ModelUncertainty ModelUncertaintyOf(const json& document) {
  ModelUncertainty model;
  model.unknowns = document.at("unknowns");
  model.covariance = MatrixOf(document.at("covariance"));
  model.freedom = document.at("freedom");
  model.duration = document.at("duration");
  model.runs = document.at("runs");
  return model;
}

json ModelUncertaintyJson(const ModelUncertainty& model) {
  return {{"unknowns", model.unknowns},
          {"covariance", MatrixJson(model.covariance)},
          {"freedom", model.freedom},
          {"duration", model.duration},
          {"runs", model.runs}};
}

void RequireModelUncertainty(const ModelUncertainty& model,
                             const std::filesystem::path& file) {
  if (!model.any()) return;
  const auto n = static_cast<Index>(model.unknowns.size());
  Require(model.covariance.rows() == n && model.covariance.cols() == n, file,
          "its model uncertainty is of another size",
          "a row and a column for each of its unknowns");
  Require(model.covariance.allFinite() &&
              (model.covariance.diagonal().array() >= 0.0).all(),
          file, "its model uncertainty is none", "finite numbers, variances >= 0");
  Require(model.freedom > 0.0 && model.duration > 0.0 && model.runs > 0, file,
          "its model uncertainty comes from nothing",
          "degrees of freedom, a duration and runs > 0");
}

}  // namespace

Calibration ReadCalibration(const std::filesystem::path& file) {
  Calibration calibration;
  try {
    const json document = json::parse(ReadTextFile(file));
    Require(document.at("schema") == kCalibrationSchema, file, "is of another schema",
            kCalibrationSchema);
    for (const json& number : document.at("numbers")) {
      calibration.numbers.push_back(number.at("name"));
      calibration.factors.conservativeResize(calibration.factors.size() + 1);
      calibration.factors[calibration.factors.size() - 1] = number.at("factor");
    }
    const auto n = static_cast<Index>(calibration.numbers.size());
    calibration.root = MatrixOf(document.at("root"));
    Require(calibration.root.rows() == n && calibration.root.cols() == n, file,
            "its root is of another size",
            "a row and a column for each of the numbers");
    Require(calibration.root.allFinite(), file, "a row of its root is none",
            "finite numbers");
    calibration.sensor_noise = VectorOf(document.at("sensor_noise"));
    calibration.force_noise = document.at("force_noise");
    calibration.records = document.at("records");
    // Files of earlier versions have neither.
    calibration.tolerated = document.value("tolerated", 1.0);
    if (document.contains("model_uncertainty")) {
      calibration.model = ModelUncertaintyOf(document["model_uncertainty"]);
    }
  } catch (const json::exception& error) {
    throw InputError(file.string(), error.what(), "a file that mjdiag calibrate wrote");
  }
  Require((calibration.factors.array() > 0.0).all() && calibration.factors.allFinite(),
          file, "a factor is not above 0", "finite numbers > 0");
  Require((calibration.sensor_noise.array() > 0.0).all(), file,
          "a noise is not above 0", "a standard deviation > 0 of every sensor");
  Require(std::isfinite(calibration.force_noise) && calibration.force_noise >= 0.0,
          file, "its force noise is below 0", "a bandwidth >= 0");
  Require(std::isfinite(calibration.tolerated) && calibration.tolerated >= 1.0, file,
          "what it tolerates is below 1", "a factor >= 1");
  RequireModelUncertainty(calibration.model, file);
  return calibration;
}

void WriteCalibration(const std::filesystem::path& file,
                      const Calibration& calibration) {
  json document = {{"schema", kCalibrationSchema},
                   {"records", calibration.records},
                   {"force_noise", calibration.force_noise},
                   {"sensor_noise", VectorJson(calibration.sensor_noise)},
                   {"tolerated", calibration.tolerated},
                   {"numbers", json::array()},
                   {"root", MatrixJson(calibration.root)}};
  const Eigen::VectorXd sd = calibration.Sd();
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    const auto at = static_cast<Index>(i);
    document["numbers"].push_back({{"name", calibration.numbers[i]},
                                   {"factor", calibration.factors[at]},
                                   {"sd", sd[at]}});
  }
  if (calibration.model.any()) {
    document["model_uncertainty"] = ModelUncertaintyJson(calibration.model);
  }
  WriteTextFile(file, document.dump(1) + "\n");
}

}  // namespace mjdiag
