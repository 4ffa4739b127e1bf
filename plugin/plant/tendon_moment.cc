#include "mjdiag/plugin/plant/tendon_moment.h"

#include <algorithm>

#include "mjdiag/plugin/plant/mujoco_model.h"

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

Eigen::MatrixXd TendonMoments(const mjModel& model, const mjtNum* qpos) {
  Eigen::MatrixXd moments(model.nv, model.ntendon);
  if (model.ntendon == 0) return moments;
  const DataPtr data = MakeData(model);
  std::copy_n(qpos, model.nq, data->qpos);
  mj_kinematics(&model, data.get());
  mj_comPos(&model, data.get());
  mj_tendon(&model, data.get());
  for (int tendon = 0; tendon < model.ntendon; ++tendon) {
    moments.col(tendon) = TendonMoment(model, *data, tendon);
  }
  return moments;
}

}  // namespace mjdiag
