#pragma once
// diagnosis.json: the answer of a diagnosis for other programs, schema
// "mjdiag.diagnosis/1".

#include <string>

#include "mjdiag/diagnosis/diagnosis_result.h"

namespace mjdiag {

/// The document as text; other members may be added to it.
std::string DiagnosisJson(const DiagnosisResult& result);

}  // namespace mjdiag
