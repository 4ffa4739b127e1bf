#include "mjdiag/studies/twin_listening.h"

#include <algorithm>
#include <memory>

#include "mjdiag/plugin/design/machine_twin.h"

namespace mjdiag {

TwinReading Listen(const Machine& machine, const Record& record, bool linear) {
  const std::unique_ptr<TwinEstimator> twin = MakeTwinEstimator(machine, linear);
  const Eigen::MatrixXd y =
      SamplesOf(record, ChannelsOf(machine.setup().channels.sensors));
  const Eigen::MatrixXd u =
      SamplesOf(record, ChannelsOf(machine.setup().channels.actuators));
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    twin->Add({y.col(k).data(), static_cast<std::size_t>(y.rows())},
              {u.col(k).data(), static_cast<std::size_t>(u.rows())});
  }
  twin->CatchUp();
  return twin->Read();
}

Eigen::VectorXd DeviationsOf(const Setup& setup, const std::vector<std::string>& names,
                             const std::vector<SizedFault>& faults) {
  Eigen::VectorXd deviations =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names.size()));
  for (const SizedFault& fault : faults) {
    const auto found = std::find(names.begin(), names.end(), fault.name);
    if (found == names.end()) continue;  // who makes the run says so
    deviations[found - names.begin()] =
        fault.value - (IsDisturbance(setup, fault.name) ? 0.0 : 1.0);
  }
  return deviations;
}

}  // namespace mjdiag
