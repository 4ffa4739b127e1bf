#pragma once
// diagnosis.json: the answer of a diagnosis for other programs, schema
// "mjdiag.diagnosis/1".

#include <nlohmann/json.hpp>

#include "mjdiag/diagnosis/diagnosis_result.h"

namespace mjdiag {

nlohmann::json ToJson(const DiagnosisResult& result);

}  // namespace mjdiag
