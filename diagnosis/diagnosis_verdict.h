#pragma once
// What a diagnosis says in words, strongest first.
//
// Faults are ranked by their significance |deviation| / sd. Where they were estimated
// without a twin, from the residuals of a healthy design, a large fault leaks into the
// others: with damping up by a fifth, a motor constant reads 1 - 4e-7, many times its
// standard deviation and of no interest. The sentence then leaves out what is dwarfed
// by the strongest.

#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_result.h"

namespace mjdiag {

/// Without a twin a detected fault is named only if its significance is at least this
/// part of the strongest one's.
inline constexpr double kNamedSignificance = 0.05;

/// Detected faults first, by falling significance; the others keep their order.
std::vector<FaultVerdict> RankedFaults(const DiagnosisResult& result);

/// Of a fault parameter, which is near 1 more often than not: 1.01, not 1.0100.
std::string ParameterText(double value);

/// "yes" or "no".
std::string DetectionText(const FaultVerdict& fault);

/// Where the uncertainty of the model bounds what is seen: from which size on faults are
/// named, and from which on with more healthy records. Empty where it does not.
std::string ModelText(const DiagnosisResult& result);

/// The answer in one sentence. Detected faults whose value reads as healthy in five
/// digits are left out of it as well, unless none is left: then the strongest is named
/// by its deviation, "eta_z = 1 - 4.00e-07".
std::string DiagnosisVerdict(const DiagnosisResult& result);

}  // namespace mjdiag
