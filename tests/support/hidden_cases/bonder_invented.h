#pragma once
// The invented laws of the wire bonder by where they are; BonderInventedCases has all.

#include <vector>

#include "support/hidden_cases/hidden_case.h"

namespace mjdiag::test {

/// In its drives, its encoders and its floor.
std::vector<HiddenCase> InventedDriveCases();

}  // namespace mjdiag::test
