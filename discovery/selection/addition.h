#pragma once
// The move that adds a hypothesis. What a screening of the rest finds (screening.h) is
// made a short list; those on it are fitted together with what has been found, first on
// the beginning of the record, then, those that are still in the race, on all of the
// train part (cause_fit.h). They are proposed in the order of their criteria.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/selection/hypothesis.h"
#include "mjdiag/discovery/selection/search_data.h"

namespace mjdiag {

/// Starts that are worth a fit beside the present set: more than chance, and near
/// enough to the best of them. The best start of every candidate first, then second
/// ones, so that a flexible law with many starts does not crowd out a simple one.
/// @param most  of the first, and twice as many as of the second
std::vector<Start> Shortlist(const SearchData& data, const Evidence& present,
                             const Screening& screening, const Chance& chance,
                             int most);

/// Sets with one more hypothesis each.
struct Additions {
  std::vector<CauseFit> fits;  ///< best first; the new one is the last of their causes
  std::vector<CauseFit> incredible;  ///< of which no name is worth anything
  /// What competes for the place: the new ones of `fits`, in the same order, then those
  /// that were too far behind for a fit.
  std::vector<Hypothesis> hypotheses;
};

Additions ProposeAdditions(const SearchData& data, const Evidence& present,
                           const std::vector<Start>& shortlist,
                           const std::function<void(const std::string& what)>& report);

}  // namespace mjdiag
