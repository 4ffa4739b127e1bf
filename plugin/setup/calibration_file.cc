#include "mjdiag/plugin/setup/calibration_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nlohmann::json;

constexpr const char* kCalibrationSchema = "mjdiag.calibration/1";

VectorXd Vector(const json& array) {
  const auto values = array.get<std::vector<double>>();
  return VectorXd::Map(values.data(), static_cast<Index>(values.size()));
}

void Require(bool fulfilled, const std::filesystem::path& file, const char* what,
             const char* expected) {
  if (!fulfilled) throw InputError(file.string(), what, expected);
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
    calibration.covariance = MatrixXd::Zero(n, n);
    const json& rows = document.at("covariance");
    Require(rows.size() == calibration.numbers.size(), file,
            "its covariance is of another size", "a row for each of the numbers");
    for (Index i = 0; i < n; ++i) {
      const VectorXd row = Vector(rows.at(static_cast<std::size_t>(i)));
      Require(row.size() == n && row.allFinite() && row[i] > 0.0, file,
              "a row of its covariance is none", "finite numbers, variances > 0");
      calibration.covariance.row(i) = row.transpose();
    }
    calibration.sensor_noise = Vector(document.at("sensor_noise"));
    calibration.force_noise = document.at("force_noise");
    calibration.records = document.at("records");
  } catch (const json::exception& error) {
    throw InputError(file.string(), error.what(), "a file that mjdiag calibrate wrote");
  }
  Require((calibration.factors.array() > 0.0).all() && calibration.factors.allFinite(),
          file, "a factor is not above 0", "finite numbers > 0");
  Require((calibration.sensor_noise.array() > 0.0).all(), file,
          "a noise is not above 0", "a standard deviation > 0 of every sensor");
  Require(std::isfinite(calibration.force_noise) && calibration.force_noise >= 0.0,
          file, "its force noise is below 0", "a bandwidth >= 0");
  return calibration;
}

void WriteCalibration(const std::filesystem::path& file,
                      const Calibration& calibration) {
  json document = {
      {"schema", kCalibrationSchema},
      {"records", calibration.records},
      {"force_noise", calibration.force_noise},
      {"sensor_noise", std::vector<double>(calibration.sensor_noise.begin(),
                                           calibration.sensor_noise.end())},
      {"numbers", json::array()},
      {"covariance", json::array()}};
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    const auto at = static_cast<Index>(i);
    document["numbers"].push_back({{"name", calibration.numbers[i]},
                                   {"factor", calibration.factors[at]},
                                   {"sd", std::sqrt(calibration.covariance(at, at))}});
    const VectorXd row = calibration.covariance.row(at).transpose();
    document["covariance"].push_back(std::vector<double>(row.begin(), row.end()));
  }
  WriteTextFile(file, document.dump(1) + "\n");
}

}  // namespace mjdiag
