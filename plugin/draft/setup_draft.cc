#include "mjdiag/plugin/draft/setup_draft.h"

#include <algorithm>
#include <numbers>
#include <set>
#include <utility>

#include "mjdiag/plugin/draft/draft_rates.h"
#include "mjdiag/plugin/draft/log_columns.h"
#include "mjdiag/plugin/draft/log_draft.h"
#include "mjdiag/plugin/draft/plant_places.h"

namespace mjdiag {
namespace {

std::string NameOfMachine(const mjModel& model, const std::filesystem::path& plant) {
  const std::string name = model.names;
  // What MuJoCo calls a model that has no name.
  if (name.empty() || name == "MuJoCo Model") return plant.stem().string();
  return name;
}

/// Positions of all joints, and all actuators.
void DraftWithoutLog(const mjModel& model, SetupDraft& draft) {
  for (const Reading& reading : PlantReadings(model)) {
    if (reading.quantity != Quantity::kPosition) continue;
    AddSensor(model, reading, nullptr, "", draft);
  }
  const std::vector<Drive> drives = PlantDrives(model);
  for (const Drive& drive : drives) {
    // A plant that has motors has those that it has.
    if (drive.actuator < 0 && model.nu > 0) continue;
    AddActuator(model, drive, nullptr, "", draft);
  }
  if (draft.sensors.empty()) {
    draft.questions.emplace_back(
        "no slide, no hinge and no position sensor: write the sensors of the machine "
        "into its MJCF");
  }
  if (draft.actuators.empty()) {
    draft.questions.emplace_back("nothing drives the plant: write its <actuator>");
  }
}

}  // namespace

SetupDraft DraftSetup(const SourcePlant& source, const std::filesystem::path& plant,
                      const std::filesystem::path& record) {
  const mjModel& model = *source.model;
  SetupDraft draft;
  draft.plant = plant;
  draft.record = record;
  draft.name = NameOfMachine(model, plant);
  draft.additions.is_urdf = source.is_urdf;
  if (source.is_urdf) {
    draft.added.emplace_back("the URDF as an MJCF, as MuJoCo reads it");
  }
  if (record.empty()) {
    DraftRates(model, 0.0, draft);
    DraftWithoutLog(model, draft);
    return draft;
  }
  const LogColumns log = ReadLogColumns(record);
  DraftRates(model, log.interval, draft);
  DraftWithLog(model, log, draft);
  return draft;
}

}  // namespace mjdiag
