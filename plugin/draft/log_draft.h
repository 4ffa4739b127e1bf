#pragma once
// The channels of a drafted setup.

#include <mujoco/mujoco.h>

#include <string>

#include "mjdiag/plugin/draft/log_columns.h"
#include "mjdiag/plugin/draft/plant_places.h"
#include "mjdiag/plugin/draft/setup_draft.h"

namespace mjdiag {

/// A sensor channel, and the sensor where the plant lacks it.
/// @param column  null: without a log
/// @param unit    of a column that says none; empty otherwise
void AddSensor(const mjModel& model, const Reading& reading, const ColumnWords* column,
               const std::string& unit, SetupDraft& draft);

/// An actuator channel, and the motor where the plant lacks it.
void AddActuator(const mjModel& model, const Drive& drive, const ColumnWords* column,
                 const std::string& unit, SetupDraft& draft);

/// All channels of a log, what was assumed of them, and what could not be told.
void DraftWithLog(const mjModel& model, const LogColumns& log, SetupDraft& draft);

}  // namespace mjdiag
