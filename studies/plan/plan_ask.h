#pragma once
// [ask]: what is asked of the runs of a plan. The answer is tables (studies/answer.h), where
// a plan that asks nothing becomes a data set. What each question means, and how it is
// answered, the header of its study says.

#include <string>
#include <variant>
#include <vector>

namespace mjdiag {

/// bound_study.h
struct AskBound {
  static constexpr const char* kQuestion = "information bound";
};

using PlanAsk = std::variant<AskBound>;

}  // namespace mjdiag
