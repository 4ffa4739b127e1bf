#pragma once
// The extended plant as text: the user's MJCF and setup with the causes that were found
// in them. Both are edited, not generated: comments, order and layout stay, so that a
// diff with the old files shows what was found and nothing else.
//
// What MuJoCo has itself, native effects and fault parameters, becomes attributes of
// the named elements, with all digits; docs/effects.md says of every effect which.
// White noise becomes noise of the sensor in the setup; every other effect
// <custom><numeric name="effect.<name>.<site>" data="..."/>, which mjdiag turns into
// forces and which stock MuJoCo ignores.

#include <mujoco/mujoco.h>

#include <filesystem>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// The MJCF file with numbers, faults and effects in it, to be written into `folder`. Includes
/// are written out in place; folders of meshes and textures are given from there.
/// @param mjcf   the nominal plant
/// @param plant  what LoadPlant makes of it; its values are what changes. Static
///               friction that its setup switches off stays off
/// InputError as CheckEffect and ApplyFault; if an element is not written out under its
/// own name; if masses are derived in a way that a single one cannot be changed; or if
/// the text would replace the nominal plant.
std::string ExtendMjcf(const std::filesystem::path& mjcf, const mjModel& plant,
                       const Changes& changes, const std::filesystem::path& folder);

/// The setup file for that plant, with plant = "plant.xml" and " (extended)" behind the
/// name. `analytic` and `published` describe the old plant and are left out, and static
/// friction is that of plant.xml.
/// @param setup_file  the nominal one, or its folder
/// @param setup       what ReadSetup makes of it
/// InputError if the text would replace the nominal setup.
std::string ExtendSetup(const std::filesystem::path& setup_file, const Setup& setup,
                        const std::vector<PlacedEffect>& effects,
                        const std::filesystem::path& folder);

}  // namespace mjdiag
