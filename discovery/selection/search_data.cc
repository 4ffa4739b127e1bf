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

std::optional<FittedModel> SearchData::AtItsEnd(const FittedModel& model) const {
  const auto simpler = SimplerThan(model.causes.back(), model);
  if (!simpler) return std::nullopt;
  FittedModel at_its_end = model;
  at_its_end.causes.back() = *simpler;
  return at_its_end;
}

}  // namespace mjdiag
