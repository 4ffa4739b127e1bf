#pragma once
// Folders that are setups of their own: of an extended plant, of a calibrated machine, and
// of one that follows another trajectory.
// Every command takes them, and the plants load in stock MuJoCo.

#include <filesystem>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/setup/calibration_file.h"

namespace mjdiag {

/// The file of a setup whose text will go into another folder. InputError if that is its
/// own.
std::filesystem::path FileForOther(const std::filesystem::path& setup,
                                   const std::filesystem::path& folder);

/// Makes a folder with plant.xml and setup.toml of a machine with those changes, and
/// effects.py where plant.xml carries effects that MuJoCo does not have (effects_file.h).
/// @param setup    of the machine, a file or its folder
/// @param machine  as that setup has it
/// @return plant.xml. InputError as ExtendMjcf and ExtendSetup; no file is written if one
///         of them cannot be made
std::filesystem::path WriteExtendedSetup(const std::filesystem::path& folder,
                                         const std::filesystem::path& setup,
                                         const Machine& machine,
                                         const Changes& changes);

/// Makes a folder with everything that stands beside a setup, with the setup that names the
/// calibration, with calibration.json and with filters.json, whose limits hold for the
/// healthy runs.
/// @param setup  of the machine, a file or its folder. InputError if it is in `folder`
void WriteCalibratedSetup(const std::filesystem::path& folder,
                          const std::filesystem::path& setup,
                          const Calibration& calibration,
                          const DiagnosisDesign& filters);

/// Makes a folder with everything that stands beside a setup, with the setup whose default
/// trajectory that one is.
/// @param setup  of the machine, a file or its folder. InputError if it is in `folder`, or
///               has a trajectory of that name
void WriteSetupFollowing(const std::filesystem::path& folder,
                         const std::filesystem::path& setup,
                         const Trajectory& trajectory);

}  // namespace mjdiag
