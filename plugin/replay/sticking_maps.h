#pragma once
// The linear map of a physics step, for every set of joints and tendons that stick in it,
//
//   [dq; dv]' : dv' = [Q V] [dq; dv] + G df,    dq' = dq + h dv'
//   G = h (M + h D)^-1 M W^-1,    Q = -G K,    V = I - G (D + B),
//   W = M + sum of r J^T J,    B = sum of r b J^T J    over what sticks,
//
// J of a joint e^T, of a tendon its moments; r = efc_D the stiffness with which MuJoCo's
// constraint holds it, b its damping ("Computation", MuJoCo 2.2: the soft constraint).
// The last sixteen sets are kept: a machine sticks in few.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace mjdiag {

class StickingMaps {
 public:
  struct Map {
    std::uint64_t sticking = 0;
    bool known = false;
    Eigen::MatrixXd QV, G;  ///< in whole registers (wide_product.h)
  };

  /// @param moments  of tendons, nv x tendons
  explicit StickingMaps(const Eigen::MatrixXd& moments);

  /// Numbers of the machine have changed.
  void Forget() noexcept;
  /// How a degree of freedom, or behind all of them a tendon, is held where it sticks.
  void Hold(Eigen::Index place, double r, double rb) noexcept;
  /// The map of a set of places; null if it is not known.
  const Map* Find(std::uint64_t sticking) const noexcept;
  /// Makes it, in the place of the oldest.
  /// @param M,K,D  of the machine where nothing sticks, nv x nv
  /// @param h      physics step [s]
  const Map& Make(std::uint64_t sticking, const Eigen::MatrixXd& M,
                  const Eigen::MatrixXd& K, const Eigen::MatrixXd& D,
                  double h) noexcept;

 private:
  /// A matrix with r e e^T, r J^T J of what sticks in it.
  void AddSticking(std::uint64_t sticking, const std::vector<double>& r,
                   Eigen::MatrixXd& matrix) const noexcept;

  Eigen::MatrixXd moments_;
  std::array<Map, 16> maps_;
  std::size_t next_ = 0;
  Eigen::MatrixXd held_, identity_, inverse_;  // work space
  Eigen::LLT<Eigen::MatrixXd> factor_;
  std::vector<double> r_, rb_;  // by dof, then by tendon
};

}  // namespace mjdiag
