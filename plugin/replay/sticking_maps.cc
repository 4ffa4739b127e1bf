#include "mjdiag/plugin/replay/sticking_maps.h"

#include "mjdiag/signals/wide_product.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;

StickingMaps::StickingMaps(const MatrixXd& moments)
    : moments_(moments), factor_(moments.rows()) {
  const Index nv = moments.rows();
  for (Map& map : maps_) {
    map.QV = MatrixXd::Zero(WideRows(nv), 2 * nv);
    map.G = MatrixXd::Zero(WideRows(nv), nv);
  }
  held_ = identity_ = inverse_ = MatrixXd::Identity(nv, nv);
  r_.assign(static_cast<std::size_t>(nv + moments.cols()), 0.0);
  rb_ = r_;
}

void StickingMaps::Forget() noexcept {
  for (Map& map : maps_) map.known = false;
}

void StickingMaps::Hold(Index place, double r, double rb) noexcept {
  r_[static_cast<std::size_t>(place)] = r;
  rb_[static_cast<std::size_t>(place)] = rb;
}

const StickingMaps::Map* StickingMaps::Find(std::uint64_t sticking) const noexcept {
  for (const Map& map : maps_) {
    if (map.known && map.sticking == sticking) return &map;
  }
  return nullptr;
}

const StickingMaps::Map& StickingMaps::Make(std::uint64_t sticking, const MatrixXd& M,
                                            const MatrixXd& K, const MatrixXd& D,
                                            double h) noexcept {
  Map& map = maps_[next_];
  next_ = (next_ + 1) % maps_.size();
  map.sticking = sticking;
  map.known = true;
  const Index nv = M.rows();
  held_ = M;
  AddSticking(sticking, r_, held_);
  factor_.compute(held_);
  inverse_ = identity_;
  factor_.solveInPlace(inverse_);
  auto G = map.G.topRows(nv);
  G.noalias() = M * inverse_;
  held_ = M + h * D;
  factor_.compute(held_);
  factor_.solveInPlace(G);
  G *= h;
  map.QV.topLeftCorner(nv, nv).noalias() = -G * K;
  held_ = D;
  AddSticking(sticking, rb_, held_);
  auto V = map.QV.topRightCorner(nv, nv);
  V = identity_;
  V.noalias() -= G * held_;
  return map;
}

void StickingMaps::AddSticking(std::uint64_t sticking, const std::vector<double>& r,
                               MatrixXd& matrix) const noexcept {
  const Index nv = matrix.rows();
  for (Index j = 0; j < std::ssize(r); ++j) {
    if ((sticking >> j & 1) == 0) continue;
    const double stiff = r[static_cast<std::size_t>(j)];
    if (j < nv) {
      matrix(j, j) += stiff;
      continue;
    }
    for (Index i = 0; i < nv; ++i) {
      matrix.col(i) += stiff * moments_(i, j - nv) * moments_.col(j - nv);
    }
  }
}

}  // namespace mjdiag
