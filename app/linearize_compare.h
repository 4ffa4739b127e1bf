#pragma once
// What `mjdiag linearize` sets the linear model of a machine against.

#include <nlohmann/json.hpp>
#include <string>

#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag::app {

struct Answer {
  std::string text;
  bool good = true;  ///< they agree
};

/// The setup's analytic model, and MuJoCo's finite differences: `difference` of the document.
/// InputError without an analytic model or with one of other joints and channels.
Answer CompareWithAnalytic(const Machine& machine, nlohmann::json& document);

/// The setup's published parity relation: `published` of the document. InputError
/// without one.
Answer ComparePublished(const Machine& machine, nlohmann::json& document);

}  // namespace mjdiag::app
