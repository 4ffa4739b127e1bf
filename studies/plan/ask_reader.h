#pragma once
// [ask] of a plan.

#include "mjdiag/plugin/setup/toml_table.h"
#include "mjdiag/studies/plan/plan_ask.h"

namespace mjdiag {

/// What the key `question` names, with its own keys.
PlanAsk ReadAsk(const TomlTable& table);

}  // namespace mjdiag
