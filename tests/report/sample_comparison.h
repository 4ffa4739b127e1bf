#pragma once
// A small comparison for the tests of this folder: q is 3 um off after 0.5 s, u is not.

#include "mjdiag/discovery/comparison/comparison.h"

namespace mjdiag {

inline Comparison SampleComparison() {
  constexpr Eigen::Index kSamples = 1000;
  Comparison comparison;
  comparison.setup = "stage <1>";
  comparison.closed_loop = true;
  comparison.options.skip_samples = 10;
  comparison.measured = Record(1e-3);
  comparison.simulated = Record(1e-3);
  const Eigen::VectorXd position = Eigen::VectorXd::LinSpaced(kSamples, 0.1, 0.2);
  Eigen::VectorXd off = position;
  off.tail(kSamples / 2).array() += 3e-6;
  comparison.measured.Add({"q", "m", off});
  comparison.simulated.Add({"q", "m", position});
  const Eigen::VectorXd volts = Eigen::VectorXd::Ones(kSamples);
  comparison.measured.Add({"u", "V", volts});
  comparison.simulated.Add({"u", "V", volts});
  for (const char* name : {"q", "u"}) {
    const NoiseFloor floor{2e-8, kSamples, kSamples, {}};
    comparison.channels.push_back(MeasureMismatch(
        comparison.measured, comparison.simulated, name, floor, comparison.options));
  }
  comparison.derived = {{"q_velocity", "m/s", 1e-3, 0.25}, {"force", "N", 2.0, 4.5}};
  comparison.not_measured = {"w"};
  return comparison;
}

}  // namespace mjdiag
