#include "mjdiag/discovery/selection/search_data.h"

#include "mjdiag/discovery/fitting/nested_law.h"

namespace mjdiag {

std::optional<FittedCause> SearchData::SimplerThan(const FittedCause& cause,
                                                   const FittedModel& model) const {
  auto simpler = SimplerLaw(problem.machine().plant(), candidates, cause);
  if (!simpler || IsForbidden(simpler->candidate)) return std::nullopt;
  if (Has(model.causes, simpler->candidate)) return std::nullopt;
  return simpler;
}

}  // namespace mjdiag
