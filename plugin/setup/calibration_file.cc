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
  json document = {{"schema", kCalibrationSchema},
                   {"records", calibration.records},
                   {"force_noise", calibration.force_noise},
                   {"sensor_noise", VectorJson(calibration.sensor_noise)},
                   {"numbers", json::array()},
                   {"root", MatrixJson(calibration.root)}};
  const Eigen::VectorXd sd = calibration.Sd();
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    const auto at = static_cast<Index>(i);
    document["numbers"].push_back({{"name", calibration.numbers[i]},
                                   {"factor", calibration.factors[at]},
                                   {"sd", sd[at]}});
  }
  WriteTextFile(file, document.dump(1) + "\n");
}

}  // namespace mjdiag
