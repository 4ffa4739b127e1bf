#include "mjdiag/studies/answer.h"

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/bound_study.h"
#include "mjdiag/studies/calibration_study.h"
#include "mjdiag/studies/classification_study.h"
#include "mjdiag/studies/detection_study.h"
#include "mjdiag/studies/disturbance_study.h"
#include "mjdiag/studies/endurance_study.h"
#include "mjdiag/studies/estimation_study.h"
#include "mjdiag/studies/random_fault_study.h"
#include "mjdiag/studies/tolerance_study.h"

namespace mjdiag {

std::vector<StudyTable> AnswerTo(const LoadedPlan& plan, const StudyOptions& options) {
  if (!plan.plan.ask) {
    throw InputError("plan '" + plan.plan.name + "'", "asks nothing", "a table [ask]");
  }
  return std::visit([&](const auto& ask) { return AnswerTo(ask, plan, options); },
                    *plan.plan.ask);
}

}  // namespace mjdiag
