#pragma once
// Where a machine rests whose numbers are not those of its model. About the nominal
// rest, with springs K(theta) and forces f(theta) that are not in balance any more,
//
//   K x0 = f,    d x0 / d theta = K^-1 (d f / d theta - d K / d theta x0)
//
// without what nothing holds, which stays where it is.

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/diagnosis/twin/model_part.h"

namespace mjdiag {

class MovedRest {
 public:
  /// @param unknowns  p, of theta
  MovedRest(const MechanicalModel& nominal, const std::vector<ModelPart>& parts,
            Eigen::Index unknowns);

  // Nothing below allocates, locks or throws.

  void Find(const Eigen::VectorXd& theta) noexcept;
  const Eigen::VectorXd& position() const { return position_; }        ///< x0, nq
  const Eigen::MatrixXd& sensitivity() const { return sensitivity_; }  ///< nq x p

 private:
  std::vector<ModelPart> parts_;  // that act at rest
  bool moves_ = false;
  Eigen::MatrixXd held_;  // nominal K, with springs for what nothing holds
  Eigen::MatrixXd K_;
  Eigen::VectorXd force_, position_, moved_;
  Eigen::MatrixXd sensitivity_;
  Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

}  // namespace mjdiag
