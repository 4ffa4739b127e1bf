#pragma once
// What names leave open, decided by the balance of forces (force_balance.h): which unit
// columns are in that say none, and which of several columns drives a motor.

#include <mujoco/mujoco.h>

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/draft/log_columns.h"
#include "mjdiag/plugin/draft/plant_places.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// A column and how many SI units a unit of it is.
struct ScaledColumn {
  std::size_t column = 0;
  double factor = 1.0;
};

/// What columns are taken for.
struct LogReading {
  std::map<int, ScaledColumn> joints;  ///< position of a joint
  std::map<int, ScaledColumn> motors;  ///< control of an actuator
  std::map<int, ScaledColumn> forces;  ///< force on a joint that no actuator drives yet
};

class LogPhysics {
 public:
  /// @param columns  all that a reading may name
  LogPhysics(const mjModel& model, const LogColumns& log,
             const std::vector<std::size_t>& columns);

  /// None where nothing can be said: a joint that no column is of, actuators with
  /// dynamics, a log that does not move.
  std::optional<double> Imbalance(const LogReading& reading, int lag = 0) const;

  /// Largest magnitude of a column, as it stands in the file.
  std::optional<double> Largest(std::size_t column) const;

  double sample_time() const { return record_ ? record_->sample_time() : 0.0; }

 private:
  const mjModel& model_;
  const LogColumns& log_;
  std::optional<Record> record_;
};

/// A imbalance from which on the terms do not cancel enough to decide anything.
inline constexpr double kBalanced = 0.8;

}  // namespace mjdiag
