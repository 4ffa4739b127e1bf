#pragma once
// What a plan asks, answered: tables on stdout as they grow, in study.json and on a page.

#include <string>

#include "app/output.h"
#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag::app {

/// How an answer is labelled.
struct AnswerLabel {
  const char* kind = "plan";  ///< or "preset"
  std::string name;
  int runs = 0;         ///< that were asked for
  bool linear = false;  ///< that plant was asked for
};

void AnswerPlan(const LoadedPlan& loaded, const AnswerLabel& label,
                const OutputOptions& output);

}  // namespace mjdiag::app
