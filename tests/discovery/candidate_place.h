#pragma once
// Candidates by their names.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"

namespace mjdiag::test {

/// Place of a candidate among all by its name, "coulomb_friction@load".
inline std::size_t Place(const std::vector<Candidate>& candidates,
                         const std::string& name) {
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (CandidateName(candidates[i]) == name) return i;
  }
  ADD_FAILURE() << "no candidate " << name;
  return 0;
}

}  // namespace mjdiag::test
