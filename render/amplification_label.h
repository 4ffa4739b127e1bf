#pragma once
// How a picture says by how much its motion is enlarged.

#include <string>
#include <vector>

#include "mjdiag/render/amplification.h"

namespace mjdiag {

/// Wordings from long to short, for the caller to take the first that fits; "flexing"
/// and "twisting" are compliant joints, "off course" and "off angle" is what driven
/// ones do other than the reference run. Empty text if nothing is enlarged.
std::vector<std::string> AmplificationLabels(const Amplification& amplification);

}  // namespace mjdiag
