#include "mjdiag/plugin/draft/log_physics.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/draft/force_balance.h"

namespace mjdiag {
namespace {

constexpr Eigen::Index kMostSamples = 20000;

}  // namespace

LogPhysics::LogPhysics(const mjModel& model, const LogColumns& log,
                       const std::vector<std::size_t>& columns)
    : model_(model), log_(log) {
  std::vector<std::string> names;
  for (const std::size_t c : columns) names.push_back(log.columns[c].name);
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  record_ = RawColumns(log, names);
  if (record_ && record_->samples() > kMostSamples) {
    record_ = record_->Slice(0, kMostSamples);
  }
}

std::optional<double> LogPhysics::Imbalance(const LogReading& reading, int lag) const {
  if (!record_ || !HasForceBalance(model_)) return std::nullopt;
  if (static_cast<int>(reading.joints.size()) != model_.njnt) return std::nullopt;
  LoggedMotion motion;
  motion.sample_time = record_->sample_time();
  motion.positions.resize(model_.nq, record_->samples());
  motion.controls.setZero(model_.nu, record_->samples());
  const auto samples = [&](const ScaledColumn& scaled) -> Eigen::RowVectorXd {
    const Channel& channel = record_->At(log_.columns[scaled.column].name);
    return scaled.factor * channel.samples.transpose();
  };
  for (const auto& [joint, scaled] : reading.joints) {
    motion.positions.row(model_.jnt_qposadr[joint]) = samples(scaled);
  }
  for (const auto& [motor, scaled] : reading.motors) {
    motion.controls.row(motor) = samples(scaled);
  }
  motion.forces.setZero(model_.nv, record_->samples());
  for (const auto& [joint, scaled] : reading.forces) {
    motion.forces.row(model_.jnt_dofadr[joint]) = samples(scaled);
  }
  return ForceImbalance(model_, motion, lag);
}

std::optional<double> LogPhysics::Largest(std::size_t column) const {
  if (!record_) return std::nullopt;
  const Channel* channel = record_->Find(log_.columns[column].name);
  if (channel == nullptr) return std::nullopt;
  return channel->samples.cwiseAbs().maxCoeff();
}

}  // namespace mjdiag
