#include "mjdiag/report/comparison_json.h"

#include "mjdiag/report/comparison_fields.h"
#include "mjdiag/signals/fields_json.h"

namespace mjdiag {

nlohmann::json ToJson(const Comparison& comparison) { return JsonOf(comparison); }

}  // namespace mjdiag
