#include "mjdiag/diagnosis/diagnosis_design.h"

#include <cmath>
#include <numbers>

namespace mjdiag {

std::vector<std::string> DiagnosisDesign::FaultNames() const {
  std::vector<std::string> names = bank.faults;
  for (const Multisine& source : disturbances) names.push_back(source.name);
  return names;
}

void Waveforms(const std::vector<Multisine>& disturbances, double time,
               Eigen::Ref<Eigen::MatrixXd> waveforms) noexcept {
  for (std::size_t i = 0; i < disturbances.size(); ++i) {
    double sum = 0.0;
    for (const double frequency : disturbances[i].frequencies) {
      sum += std::sin(2.0 * std::numbers::pi * frequency * time);
    }
    waveforms.col(static_cast<Eigen::Index>(i)) = sum * disturbances[i].amplitude;
  }
}

}  // namespace mjdiag
