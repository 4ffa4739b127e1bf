#pragma once
// What measured healthy runs have said about a machine (mjdiag calibrate): the numbers
// of its plant as they are, how sure that is, and the noise that it has.

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/twin/model_uncertainty.h"

namespace mjdiag {

struct Calibration {
  std::vector<std::string> numbers;  ///< "mass@stage", see model_parameter.h
  Eigen::VectorXd factors;           ///< of what the plant says
  /// Root R of the covariance R R^T of their logarithms, n x n: some directions may be
  /// known a million times better than others, which R still tells.
  Eigen::MatrixXd root;
  Eigen::VectorXd sensor_noise;  ///< sd of a reading, of each sensor [unit]
  /// What the model does not know, as a force noise: the bandwidth with which the twin
  /// is pulled along [Hz] (observer.h); 0: nothing.
  double force_noise = 0.0;
  /// How many times more surprising than by noise blocks of a healthy run may be
  /// (NormalizedInnovation), 1 or more.
  double tolerated = 1.0;
  ModelUncertainty model;  ///< of faults
  int records = 0;         ///< that it was learned from

  /// Standard deviations of the logarithms.
  Eigen::VectorXd Sd() const { return root.rowwise().norm(); }

  bool operator==(const Calibration&) const = default;
};

/// InputError names what is missing or malformed.
Calibration ReadCalibration(const std::filesystem::path& file);
void WriteCalibration(const std::filesystem::path& file,
                      const Calibration& calibration);

}  // namespace mjdiag
