#include "mjdiag/diagnosis/diagnosis_json.h"

#include "mjdiag/diagnosis/diagnosis_fields.h"
#include "mjdiag/signals/fields_json.h"

namespace mjdiag {

std::string DiagnosisJson(const DiagnosisResult& result) {
  return JsonOf(result).dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace mjdiag
