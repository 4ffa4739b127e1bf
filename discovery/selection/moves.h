#pragma once
// Moves from a set of hypotheses to another that add none: what a new cause means for
// those found before it. With it beside them
//
// - a wave or a resonance may have another period (wave_period.h);
// - one may be superfluous;
// - another hypothesis may be the better one in its place: the first cause of a search
//   is what explains the most on its own, and a flexible mode that made up for two
//   effects at once is a mere mass once the other one is known;
// - two may be what one does: a law and what its square takes are a larger law.
//
// Each move proposes fits, has them judged (comparator.h) and takes the best that is
// accepted into the set.

#include "mjdiag/discovery/selection/hypothesis.h"
#include "mjdiag/discovery/selection/search_data.h"

namespace mjdiag {

// Moves, as people are told of them.
inline constexpr const char* kOthers = "other causes in the place of those found";
inline constexpr const char* kBetter = "better causes in the place of those found";

/// Gives waves of the set other periods while one is accepted.
void ChangePeriods(const SearchData& data, HypothesisSet& set);

/// Drops one hypothesis; true if that was accepted of any.
bool Drop(const SearchData& data, HypothesisSet& set);

/// Puts the law that a hypothesis becomes at an end of its parameters in its place; true if
/// that was accepted of any. Before all is found the larger law wins by what it takes over
/// of the rest.
bool Simplify(const SearchData& data, HypothesisSet& set);

/// Takes out a hypothesis that is not credible beside the others (model_choice.h), or puts
/// the law that it is at its end in its place, whatever it explains; true if there was one.
/// Beside what came after it a law may be at its end that was not when it was added.
bool GiveUpIncredible(const SearchData& data, HypothesisSet& set);

/// Puts another hypothesis in the place of one; true if that was accepted. How probable
/// the rivals for a place are is judged anew in any case.
bool Exchange(const SearchData& data, HypothesisSet& set);

/// Puts a hypothesis that promises more than one in its place; true if that was accepted.
/// What is left beside a law may be what a larger one, or the right one, does.
bool Better(const SearchData& data, HypothesisSet& set, const Chance& chance);

/// Puts one hypothesis in the place of two at one joint that are its parts, or make up for
/// it together; true if that was accepted.
bool Merge(const SearchData& data, HypothesisSet& set);

}  // namespace mjdiag
