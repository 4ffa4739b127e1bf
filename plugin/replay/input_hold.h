#pragma once
// What recorded inputs do between their samples (Hold), where nobody says it. What a controller
// put out was held; what an instrument measured, a current for example, goes on between its
// samples, and held it acts half a tick late. Which of the two it was, the run says: the machine
// with the one or the other, whatever else it lacks, is the likelier one behind the noise that
// suits it (noise_fit.h).

#include <filesystem>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Channels of inputs of which a setup does not say it, and which no controller of it drives.
std::vector<std::string> InputsOfUnknownHold(const Setup& setup);

/// By how much -2 ln L of a record falls if these go straight from sample to sample in the place
/// of being held, along pieces of it; 0 where the machine does not stay with it.
/// InputError as ReadMeasured.
double GainOfStraightInputs(const Setup& setup, const std::filesystem::path& record);

}  // namespace mjdiag
