#pragma once
// A setup drafted from a plant and a log: what each column is, at which rate, in which unit,
// what the plant lacks, what was taken for granted, and what could not be told.
//
//   names and units   which column is of which joint, sensor and motor (name_match.h)
//   ranges            whether a joint can be where a column says it is
//   balance of forces which unit, which of several columns, which sign, how late
//                     (log_physics.h)
//
// Nothing that these leave open is decided: it is a question, and the draft is not certain.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/draft/plant_additions.h"

namespace mjdiag {

struct DraftedChannel {
  std::string channel;
  std::string element;
  int component = 0;
  std::string unit;         ///< SI
  std::string column;       ///< of the log; empty without one
  std::string column_unit;  ///< that the setup has to say; empty: the file says it
};

struct SetupDraft {
  std::string name;
  std::filesystem::path plant;   ///< as it was given
  std::filesystem::path record;  ///< empty without one
  double control = 0.0;          ///< [Hz]
  int substeps = 1;
  std::string time_column;
  std::string time_unit;
  std::vector<DraftedChannel> sensors;
  std::vector<DraftedChannel> actuators;
  PlantAdditions additions;
  std::vector<std::string> assumed;    ///< what was taken for granted
  std::vector<std::string> added;      ///< what the plant lacked
  std::vector<std::string> questions;  ///< what could not be told, and what to write
  std::vector<std::string> unused;  ///< columns that are nothing of the setup, and why
  std::vector<std::string> notes;

  bool certain() const { return questions.empty(); }
};

/// @param record  empty: positions of all joints and all actuators, at the plant's own rate
/// InputError as LoadModel and OpenRecordSource.
SetupDraft DraftSetup(const SourcePlant& source, const std::filesystem::path& plant,
                      const std::filesystem::path& record);

/// setup.toml, and plant.xml where the plant lacks something, in a folder that exists. The
/// files appear together.
void WriteDraft(const SetupDraft& draft, const SourcePlant& source,
                const std::filesystem::path& folder);

/// The text of setup.toml.
/// @param plant  as it is to name the plant
std::string DraftText(const SetupDraft& draft, const std::string& plant);

}  // namespace mjdiag
