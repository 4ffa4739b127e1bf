#include "mjdiag/studies/answer.h"

#include "mjdiag/signals/error.h"

namespace mjdiag {

std::vector<StudyTable> AnswerTo(const LoadedPlan& plan, const StudyOptions& options) {
  if (!plan.plan.ask) {
    throw InputError("plan '" + plan.plan.name + "'", "asks nothing", "a table [ask]");
  }
  return std::visit([&](const auto& ask) { return AnswerTo(ask, plan, options); },
                    *plan.plan.ask);
}

}  // namespace mjdiag
