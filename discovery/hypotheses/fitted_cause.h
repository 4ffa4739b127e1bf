#pragma once
// Candidates with values, and the vector of all of them that a fit works on.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"

namespace mjdiag {

/// A candidate with values.
struct FittedCause {
  std::size_t candidate = 0;  ///< in the list of candidates
  Eigen::VectorXd value;      ///< in the order of candidate.parameters
};

/// With values within the bounds of its parameters.
FittedCause Bounded(const std::vector<Candidate>& candidates, FittedCause cause);

/// Whether its shape is as far as it may be, or one of its sizes is nothing, which may not
/// be below: the fit asks for what is no such law any more, as a resonance that does not
/// swing, a wave longer than the stroke, or friction that falls with the load.
bool IsAtItsEnd(const std::vector<Candidate>& candidates, const FittedCause& cause);

/// Whether one of the causes is that candidate.
bool Has(const std::vector<FittedCause>& causes, std::size_t candidate);

int ParameterCount(const std::vector<FittedCause>& causes);

/// All parameters in one vector, in order of the causes, and back.
Eigen::VectorXd Flatten(const std::vector<FittedCause>& causes);
std::vector<FittedCause> WithValues(std::vector<FittedCause> causes,
                                    const Eigen::VectorXd& all);
/// Names and bounds in the same order.
std::vector<FitParameter> ParametersOf(const std::vector<Candidate>& candidates,
                                       const std::vector<FittedCause>& causes);

Cause CauseOf(const std::vector<Candidate>& candidates, const FittedCause& fitted);
/// Changes to the plant that the causes are.
Changes ChangesOf(const std::vector<Candidate>& candidates,
                  const std::vector<FittedCause>& causes);

/// All causes but those in these places.
std::vector<FittedCause> Without(const std::vector<FittedCause>& causes,
                                 const std::vector<std::size_t>& places);

}  // namespace mjdiag
