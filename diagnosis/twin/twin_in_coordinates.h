#pragma once
// A twin in other coordinates of what is not known, theta = T z. Numbers that measured
// runs have told together are known along some directions to a part in a hundred and
// along others to one in a billion; in coordinates z whose prior is the identity, T a
// root of the covariance, what is known beforehand and what is seen have one size.

#include <Eigen/Core>
#include <memory>

#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

class TwinInCoordinates final : public Twin {
 public:
  /// @param T      p x q, the identity for what wears, for tones and the start
  /// @param tones  those of the twin
  TwinInCoordinates(std::unique_ptr<Twin> twin, Eigen::MatrixXd T,
                    const std::vector<UnknownTone>& tones);

  void UseGain(std::size_t gain) noexcept override { twin_->UseGain(gain); }
  void Start(const Eigen::VectorXd& z) noexcept override;
  void Start(const Eigen::VectorXd& z, const TwinState& state,
             Eigen::Index tick) noexcept override;
  TwinState MakeState() const override { return twin_->MakeState(); }
  void StateAt(const Eigen::VectorXd& reading, TwinState& state) noexcept override {
    twin_->StateAt(reading, state);
  }
  void ReadState(TwinState& state) const noexcept override { twin_->ReadState(state); }
  void Predict(Eigen::VectorXd& reading) noexcept override { twin_->Predict(reading); }
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override {
    twin_->Step(inputs, innovation);
  }
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;
  double drift_time() const noexcept override { return twin_->drift_time(); }
  void UseDrift(bool use) noexcept override { twin_->UseDrift(use); }
  void Drifted(const Eigen::VectorXd& rates) noexcept override {
    twin_->Drifted(rates);
  }

 private:
  std::unique_ptr<Twin> twin_;
  Eigen::MatrixXd T_;
  Eigen::VectorXd of_twin_;
  Eigen::MatrixXd sensitivity_;
};

}  // namespace mjdiag
