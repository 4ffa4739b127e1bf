#pragma once
// diagnosis.json: the answer of a diagnosis for other programs, what diagnosis_fields.h
// describes.

#include <string>

#include "mjdiag/diagnosis/diagnosis_result.h"

namespace mjdiag {

/// The document as text; other members may be added to it.
std::string DiagnosisJson(const DiagnosisResult& result);

}  // namespace mjdiag
