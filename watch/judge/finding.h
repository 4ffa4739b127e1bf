#pragma once
// What a diagnosis says at a moment, a few times a second.

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_result.h"

namespace mjdiag {

/// The kinds of DiagnosisVerdict, and that it is too early for one.
enum class VerdictKind {
  kSettling,     ///< a run has just begun
  kHealthy,      ///< nothing is wrong
  kFault,        ///< faults are named
  kUnexplained,  ///< neither the healthy machine nor its faults explain what is seen
  kDisturbance,  ///< a tone in what is left
  kNoise,        ///< the sensors are noisier than usual
  kResidual      ///< the residual has left its limits, and nothing says why
};

/// "fault", ...
const char* NameOf(VerdictKind kind);
/// InputError if there is no such name.
VerdictKind VerdictKindOf(const std::string& name);

/// As DiagnosisVerdict puts it.
VerdictKind KindOf(const DiagnosisResult& result);

/// What was seen since the look before, in which nothing else changes.
struct Stretch {
  double least = 0.0;
  double sum = 0.0;
  double most = 0.0;
  std::int64_t count = 0;

  void Add(double value);
  double mean() const { return sum / static_cast<double>(count); }
};

struct Finding {
  double time = 0.0;            ///< of its last tick, by our clock [s since 1970]
  double run_time = 0.0;        ///< since the run of the diagnosis began [s]
  std::int64_t missing = 0;     ///< ticks since the look before
  Stretch residual;             ///< since the look before
  double integral = 0.0;        ///< mean of |r| over the setup's window
  bool residual_alarm = false;  ///< since the look before, at any tick
  bool lasting_alarm = false;   ///< now
  VerdictKind kind = VerdictKind::kSettling;
  std::string words;  ///< DiagnosisVerdict
  /// Faults, nis, and the disturbance of the last stretch that was analysed, with the
  /// tones that were in the one before, too.
  DiagnosisResult result;
  bool analysed = false;  ///< whether there was such a stretch
};

}  // namespace mjdiag
