#pragma once
// Where a machine comes from: a folder with a setup, or an MJCF, and keys that are set
// over what the setup says.

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mjdiag/signals/scratch_folder.h"

namespace mjdiag::python {

struct MachineSource {
  std::filesystem::path setup;         ///< for ReadSetup
  std::vector<std::string> overrides;  ///< the same
  /// Holds what was given as text; null if nothing was.
  std::shared_ptr<const ScratchFolder> texts{};
};

/// A value in TOML. InputError names the key of one that TOML does not have.
std::string TomlText(const std::string& key, pybind11::handle value);

/// @param machine  a folder with setup.toml, a setup file, an MJCF file (*.xml), or MJCF
///                 itself. An MJCF alone gets a setup with its scalar sensors and its
///                 actuators as channels, a tick of its time step, and no noise
/// @param plant    the MJCF in the place of that of the setup, a file or text; None
/// @param set      key -> value, or None
/// InputError
MachineSource SourceOf(const pybind11::object& machine, const pybind11::object& plant,
                       const pybind11::object& set);

}  // namespace mjdiag::python
