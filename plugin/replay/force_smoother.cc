#include "mjdiag/plugin/replay/force_smoother.h"

#include <vector>

#include "mjdiag/plugin/replay/force_kalman.h"
#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Backwards over one record.
class BackwardPass {
 public:
  BackwardPass(const FilterPath& path, const FilterNoise& noise,
               const std::vector<FilterGains>& gains, Index first,
               SmoothedForces& smoothed)
      : path_(path),
        noise_(noise),
        gains_(gains),
        first_(first),
        smoothed_(smoothed),
        n_(path.pulled.rows()),
        nf_(path.dof_count()),
        rho_(ForceKalman(path.dofs, noise, path.sample_time).rho()),
        r_(VectorXd::Zero(n_)),
        W_(MatrixXd::Zero(n_, n_)) {}

  /// @return sums of the variances of what lasts
  VectorXd Run();
  /// Behind Run: where the record began, less where the path begins.
  VectorXd Start(const VectorXd& sd) const {
    return sd.cwiseAbs2().cwiseProduct(r_.head(sd.size()));
  }

 private:
  void ThroughTick(Index k);
  void ThroughReadings(Index k, const FilterGains& gain, bool late);

  const FilterPath& path_;
  const FilterNoise& noise_;
  const std::vector<FilterGains>& gains_;
  Index first_;
  SmoothedForces& smoothed_;
  Index n_;
  Index nf_;
  VectorXd rho_;
  VectorXd r_;
  MatrixXd W_;
};

void BackwardPass::ThroughTick(Index k) {
  const TickTangent& tangent = path_.At(k);
  const Index ns = n_ - nf_ - 1;
  MatrixXd F = MatrixXd::Zero(n_, n_);
  F.topLeftCorner(ns, ns) = tangent.A;
  for (Index j = 0; j < nf_; ++j) {
    F.col(ns + j).head(ns) = tangent.B.col(path_.dofs[static_cast<std::size_t>(j)]);
  }
  F.diagonal().tail(nf_ + 1) = rho_;
  smoothed_.value.col(k) = noise_.white.cwiseAbs2().cwiseProduct(
      F.block(0, ns, ns, nf_).transpose() * r_.head(ns));
  r_ = (F.transpose() * r_).eval();
  // What rounding makes skew would grow.
  W_ = (F.transpose() * (W_ * F)).eval();
  W_ = (0.5 * (W_ + W_.transpose())).eval();
}

void BackwardPass::ThroughReadings(Index k, const FilterGains& gain, bool late) {
  const TickTangent& tangent = path_.At(k);
  const Index ns = n_ - nf_ - 1;
  const Index row = late ? k + 1 : k;
  VectorXd c(n_);
  for (Index i = path_.sensors(); i-- > 0;) {
    if (path_.late[static_cast<std::size_t>(i)] != late || gain.K.col(i).isZero(0.0)) {
      continue;
    }
    c.setZero();
    c.head(ns) = tangent.C.row(i).transpose();
    for (Index j = 0; late && j < nf_; ++j) {
      c[ns + j] = tangent.D(i, path_.dofs[static_cast<std::size_t>(j)]);
    }
    c[n_ - 1] = path_.speeds(i, row);
    const auto K = gain.K.col(i);
    const VectorXd WK = W_ * K;
    const double more = 1.0 / gain.S[i] + K.dot(WK);
    r_ += c * (gain.e[i] / gain.S[i] - K.dot(r_));
    W_ += more * (c * c.transpose()) - c * WK.transpose() - WK * c.transpose();
  }
}

VectorXd BackwardPass::Run() {
  VectorXd variance = VectorXd::Zero(nf_);
  for (Index i = std::ssize(gains_); i-- > 0;) {
    const FilterGains& gain = gains_[static_cast<std::size_t>(i)];
    const Index k = first_ + i;
    ThroughTick(k);
    ThroughReadings(k, gain, true);
    ThroughReadings(k, gain, false);
    const auto P = gain.P.topRows(nf_);
    smoothed_.value.col(k) += gain.force + P * r_;
    variance += P.middleCols(n_ - nf_ - 1, nf_).diagonal() -
                (P * W_ * P.transpose()).diagonal();
  }
  return variance;
}

}  // namespace

SmoothedForces SmoothForces(const FilterPath& path) {
  SmoothedForces smoothed{MatrixXd::Zero(path.dof_count(), path.samples()),
                          VectorXd::Zero(path.dof_count()),
                          MatrixXd::Zero(path.pulled.rows() - path.dof_count() - 1,
                                         std::ssize(path.first))};
  // The floor is a doubt about laws, and no force that is there.
  FilterNoise noise = path.noise;
  noise.floor = 0.0;
  const std::size_t records = path.first.size();
  std::vector<VectorXd> variances(records);
  ParallelFor(static_cast<int>(records), [&](int number) {
    const auto r = static_cast<std::size_t>(number);
    const Index first = path.first[r];
    const std::vector<FilterGains> gains =
        GainsAlong(path, noise, first, path.EndOf(r) - first);
    BackwardPass backward(path, noise, gains, first, smoothed);
    variances[r] = backward.Run();
    smoothed.start.col(number) = backward.Start(path.starts[r].sd);
  });
  VectorXd variance = VectorXd::Zero(path.dof_count());
  for (const VectorXd& one : variances) variance += one;
  smoothed.sd =
      (variance / static_cast<double>(path.samples())).cwiseMax(0.0).cwiseSqrt();
  return smoothed;
}

}  // namespace mjdiag
