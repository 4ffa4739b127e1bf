#pragma once
// Models that moves make of one, and which moves are worth a fit.

#include <cstddef>
#include <functional>
#include <vector>

#include "mjdiag/discovery/fit/model.h"
#include "mjdiag/discovery/regression/moves.h"

namespace mjdiag {

Model After(const ModelMove& move, const Model& model);

/// The same, friction that comes within a speed, or gives way, as one that is there at once.
Model Abrupt(const std::vector<Block>& blocks, Model model);
/// The same, friction that is there at once as one that comes within a hundredth of the
/// fastest speed.
Model Creeping(const std::vector<Block>& blocks, Model model);
/// The same, each as friction of a joint that gives way at rest.
Model GivingWay(const std::vector<Block>& blocks, Model model);
/// The same, as friction of a joint that springs before it slides.
/// @param lengths  over which, of every degree of freedom
Model Springing(const std::vector<Block>& blocks, Model model,
                const Eigen::VectorXd& lengths);

/// The same, as friction that holds by half more than it slides by.
/// @param speeds  at which it slides, of every degree of freedom
Model BreakingAway(const std::vector<Block>& blocks, Model model,
                   const Eigen::VectorXd& speeds);

/// The same, with dry friction of each joint in the form that it has in another model.
Model InFormsOf(const std::vector<Block>& blocks, Model model, const Model& other);

/// The best of all that may be, of which no block comes in with more than two, and the best that
/// brings one block and nothing else: the fewer come at once, the nearer is first order to what
/// a fit finds; and, of those that gain half as much as the best, the one that leaves the fewest. None that does
/// all that a better one does, and more.
/// @param most  1: the best alone
std::vector<const ModelMove*> ToBeFitted(
    const Moves& moves, std::size_t most,
    const std::function<bool(const ModelMove&)>& may_be);

}  // namespace mjdiag
