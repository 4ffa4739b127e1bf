#pragma once
// Which of its candidates a discovery looks at, as people name them:
//
//   friction, drive, structure, encoder   a family of effects
//   encoder_scale                         an effect, wherever it may act
//   coulomb_friction@load                 an effect at a site
//   zeta_x                                a fault parameter
//
// A fault parameter stands for the effect that is the same change of the plant
// (Indistinguishable), so it goes by the names of that as well.

#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

struct CandidateChoice {
  std::vector<std::string> only;  ///< no others; empty: all
  std::vector<std::string> without;
};

bool IsChosen(const Candidate& candidate, const CandidateChoice& choice);

/// Those of ListCandidates that the choice leaves. InputError on a name that means
/// nothing on the machine, and if none is left.
/// @param with_seen  at joints that are only seen, too
std::vector<Candidate> ChooseCandidates(const Machine& machine,
                                        const CandidateChoice& choice,
                                        bool with_seen = false);

}  // namespace mjdiag
