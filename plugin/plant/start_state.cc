#include "mjdiag/plugin/plant/start_state.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/constraint_rows.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Those sensors only that have a start reading and read a position.
Channels PositionSensors(const Channels& channels, const mjModel& model,
                         const std::map<std::string, double>& start) {
  Channels placed = channels;
  std::erase_if(placed.sensors, [&](const SensorSetup& sensor) {
    const int id = FindElement(model, mjOBJ_SENSOR, sensor.element);
    return !start.contains(sensor.channel) || StageOf(model, sensor) != mjSTAGE_POS ||
           model.sensor_type[id] == mjSENS_CLOCK;
  });
  return placed;
}

/// 1 / sigma. A sensor of which nothing is said is as good as the best of the others.
VectorXd WeightsOf(const Channels& placed) {
  VectorXd sigma(static_cast<Index>(placed.sensors.size()));
  double best = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < sigma.size(); ++i) {
    const SensorSetup& sensor = placed.sensors[static_cast<std::size_t>(i)];
    sigma[i] = std::hypot(sensor.noise_sd, sensor.resolution / std::sqrt(12.0));
    if (sigma[i] > 0.0) best = std::min(best, sigma[i]);
  }
  if (!std::isfinite(best)) best = 1.0;
  for (double& value : sigma) {
    if (value == 0.0) value = best;
  }
  return sigma.cwiseInverse();
}

/// The search for one configuration.
class StartSearch {
 public:
  StartSearch(const Channels& placed, const mjModel& model, VectorXd target)
      : placed_(placed),
        model_(model),
        target_(std::move(target)),
        weights_(WeightsOf(placed)),
        unit_(model.nv),
        forces_(model, VectorXd::Map(model.qpos0, model.nq)) {
    for (int dof = 0; dof < model.nv; ++dof) {
      unit_[dof] = 1.0 / std::sqrt(1.0 + model.jnt_stiffness[model.dof_jntid[dof]]);
    }
  }

  /// As near as it comes from there.
  VectorXd From(VectorXd qpos) {
    constexpr int kIterations = 60;
    Miss miss = MissAt(qpos);
    for (int i = 0; i < kIterations && !IsMet(miss); ++i) {
      const VectorXd step = StepAt(qpos, miss);
      double fraction = 1.0;
      VectorXd next = Displaced(model_, qpos, step);
      Miss there = MissAt(next);
      while (!(SizeOf(there) < SizeOf(miss)) && fraction > 1e-4) {
        fraction *= 0.5;
        next = Displaced(model_, qpos, fraction * step);
        there = MissAt(next);
      }
      // A step that does not help any more is what rounding and noise leave.
      if (!(SizeOf(there) < SizeOf(miss))) break;
      qpos = next;
      miss = there;
      if ((fraction * step).cwiseAbs().maxCoeff() < 1e-14) break;
    }
    return qpos;
  }

  /// Readings that are not met, each in units of what is far for it: 1 is too far.
  VectorXd Far(const VectorXd& qpos) {
    const VectorXd error = MissAt(qpos).readings;
    VectorXd far(error.size());
    for (Index i = 0; i < error.size(); ++i) {
      const bool length = placed_.sensors[static_cast<std::size_t>(i)].unit == "m";
      const double size = length ? std::max(model_.stat.extent, 1e-3) : 1.0;
      far[i] = std::abs(error[i]) / (0.1 * size);
    }
    return far;
  }

 private:
  struct Miss {
    VectorXd ties;      // of the equalities [m, rad]
    VectorXd readings;  // what sensors should read, less what they do
  };

  Miss MissAt(const VectorXd& qpos) {
    mjData& data = forces_.data();
    Miss miss;
    miss.readings = target_ - SensorReadings(placed_, model_, qpos, data);
    TurnQuaternions(miss.readings);
    const std::vector<int> rows = EqualityRows(data);
    miss.ties = -VectorXd::Map(data.efc_pos, data.nefc)(rows);
    return miss;
  }

  /// q and -q are the same orientation.
  void TurnQuaternions(VectorXd& error) const {
    for (Index first = 0; first < error.size(); ++first) {
      const auto& sensor = placed_.sensors[static_cast<std::size_t>(first)];
      const int id = FindElement(model_, mjOBJ_SENSOR, sensor.element);
      const int type = model_.sensor_type[id];
      if (type != mjSENS_FRAMEQUAT && type != mjSENS_BALLQUAT) continue;
      double product = 0.0;
      std::vector<Index> parts;
      for (Index i = 0; i < error.size(); ++i) {
        if (placed_.sensors[static_cast<std::size_t>(i)].element != sensor.element) {
          continue;
        }
        parts.push_back(i);
        product += target_[i] * (target_[i] - error[i]);
      }
      if (parts.front() != first || parts.size() < 4 || product >= 0.0) continue;
      for (const Index i : parts) error[i] -= 2.0 * target_[i];
    }
  }

  bool IsMet(const Miss& miss) const {
    const auto far =
        miss.readings.array().abs() / (1e-12 + 1e-9 * target_.array().abs());
    return far.maxCoeff() <= 1.0 &&
           (miss.ties.size() == 0 || miss.ties.cwiseAbs().maxCoeff() <= 1e-12);
  }

  /// What a step has to make smaller. Equalities outweigh readings.
  double SizeOf(const Miss& miss) const {
    constexpr double kTies = 1e3;
    return weights_.cwiseProduct(miss.readings).squaredNorm() +
           std::pow(kTies * weights_.maxCoeff(), 2) * miss.ties.squaredNorm();
  }

  VectorXd StepAt(const VectorXd& qpos, const Miss& miss) {
    const MatrixXd rows = weights_.asDiagonal() * OutputsAt(qpos) * unit_.asDiagonal();
    const VectorXd wanted = weights_.cwiseProduct(miss.readings);
    if (miss.ties.size() == 0)
      return unit_.cwiseProduct(LeastNorm(rows, wanted).col(0));
    forces_.MoveTo(qpos);
    mj_fwdPosition(&model_, &forces_.data());
    const MatrixXd ties =
        ConstraintJacobian(model_, forces_.data(), EqualityRows(forces_.data())) *
        unit_.asDiagonal();
    const MatrixXd back = PseudoInverse(ties);
    const VectorXd onto = back * miss.ties;
    const MatrixXd allowed = MatrixXd::Identity(model_.nv, model_.nv) - back * ties;
    const VectorXd along = allowed * LeastNorm(rows * allowed, wanted - rows * onto);
    return unit_.cwiseProduct(onto + along);
  }

  /// d reading / d q, sensors x nv.
  MatrixXd OutputsAt(const VectorXd& qpos) {
    const std::vector<int> addresses = SensorAddresses(placed_, model_);
    forces_.MoveTo(qpos);
    return ByPosition(forces_, [&]() -> VectorXd {
      mj_fwdPosition(&model_, &forces_.data());
      mj_sensorPos(&model_, &forces_.data());
      return VectorXd::Map(forces_.data().sensordata, model_.nsensordata)(addresses);
    });
  }

  const Channels& placed_;
  const mjModel& model_;
  VectorXd target_;
  VectorXd weights_;
  VectorXd unit_;
  PlantForces forces_;
};

/// Somewhere else: a turn of the joints by up to a radian.
VectorXd Elsewhere(const mjModel& model, const VectorXd& from,
                   std::mt19937& generator) {
  std::uniform_real_distribution<double> turn(-1.0, 1.0);
  VectorXd by = VectorXd::Zero(model.nv);
  for (int dof = 0; dof < model.nv; ++dof) {
    by[dof] = turn(generator) * (IsLength(model, dof) ? 0.1 * model.stat.extent : 1.0);
  }
  return Displaced(model, from, by);
}

}  // namespace

VectorXd SensorReadings(const Channels& channels, const mjModel& model,
                        const VectorXd& qpos) {
  const DataPtr data = MakeData(model);
  return SensorReadings(channels, model, qpos, *data);
}

VectorXd SensorReadings(const Channels& channels, const mjModel& model,
                        const VectorXd& qpos, mjData& data) {
  VectorXd::Map(data.qpos, model.nq) = qpos;
  mj_fwdPosition(&model, &data);
  mj_sensorPos(&model, &data);
  const std::vector<int> addresses = SensorAddresses(channels, model);
  return VectorXd::Map(data.sensordata, model.nsensordata)(addresses);
}

VectorXd StartPosition(const Channels& channels, const mjModel& model,
                       const VectorXd& rest,
                       const std::map<std::string, double>& start) {
  if (start.empty()) return rest;
  const Channels placed = PositionSensors(channels, model, start);
  const auto sensors = static_cast<Index>(placed.sensors.size());
  if (sensors == 0) return rest;
  VectorXd target(sensors);
  for (Index i = 0; i < sensors; ++i) {
    target[i] = start.at(placed.sensors[static_cast<std::size_t>(i)].channel);
  }
  StartSearch search(placed, model, target);
  VectorXd best = search.From(rest);
  VectorXd far = search.Far(best);
  // Where no joint changes the readings, as the height of an arm that hangs, a search that
  // goes downhill stays. Noise is nearer than that.
  constexpr int kOthers = 10;
  constexpr double kNear = 0.05;
  std::mt19937 generator;  // the same every time
  for (int i = 0; i < kOthers && !(far.maxCoeff() <= kNear); ++i) {
    const VectorXd other = search.From(Elsewhere(model, rest, generator));
    const VectorXd other_far = search.Far(other);
    if (!(other_far.maxCoeff() < 0.5 * far.maxCoeff())) continue;
    best = other;
    far = other_far;
  }
  Index worst = 0;
  if (far.maxCoeff(&worst) <= 1.0) return best;
  throw NumericalError("start: no joint positions give the first reading of '" +
                       placed.sensors[static_cast<std::size_t>(worst)].channel + "', " +
                       std::to_string(target[worst]) + "; the nearest is " +
                       std::to_string(SensorReadings(placed, model, best)[worst]));
}

}  // namespace mjdiag
