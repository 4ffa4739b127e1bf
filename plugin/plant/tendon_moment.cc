#include "mjdiag/plugin/plant/tendon_moment.h"

namespace mjdiag {

Eigen::VectorXd TendonMoment(const mjModel& model, const mjData& data, int tendon) {
  if (mj_isSparse(&model) == 0) {
    const auto row = static_cast<std::ptrdiff_t>(tendon) * model.nv;
    return Eigen::VectorXd::Map(data.ten_J + row, model.nv);
  }
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(model.nv);
  const int first = data.ten_J_rowadr[tendon];
  for (int i = first; i < first + data.ten_J_rownnz[tendon]; ++i) {
    moment[data.ten_J_colind[i]] = data.ten_J[i];
  }
  return moment;
}

}  // namespace mjdiag
