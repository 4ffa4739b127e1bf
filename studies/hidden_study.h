#pragma once
// A case of the benchmark of discovery (hidden_case.h), looked for. Where the model is not
// exact it is done as the command does it by default: numbers of the plant in doubt, a
// minute of work.

#include <cstdint>
#include <optional>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/studies/coverage.h"
#include "mjdiag/studies/hidden_case.h"
#include "mjdiag/studies/hidden_verdict.h"

namespace mjdiag {

struct HiddenOutcome {
  HiddenPlan plan;
  std::vector<Cause> truth;
  std::size_t fitted = 1;  ///< records
  std::size_t unseen = 0;  ///< of which nothing is fitted to
  Discovery answer;
  HiddenVerdict verdict = HiddenVerdict::kRight;  ///< of the catalogue, or of nothing
  OutsideVerdict outside = OutsideVerdict::kNothing;  ///< of an outside law
  std::vector<Claim> claims;
  std::vector<Claim> kind_claims;
  bool kinds_are_there = false;  ///< HasKindsOf
  /// Root mean square of what free simulation of a motion that no fit saw is off, over
  /// noise, all sensors: beside the model and beside the extended one.
  double before = 0.0;
  double after = 0.0;
  double after_worst = 0.0;  ///< the same of the worst sensor
  Coverage coverage;         ///< of the values, where the model is exact
  double seconds = 0.0;      ///< of the discovery, on this machine

  /// That anything is there, with or without a name.
  bool IsClaim() const;
  /// All is named and nothing else, nor is anything else claimed.
  bool IsRight() const {
    return verdict == HiddenVerdict::kRight && IsClaim() == !truth.empty();
  }
  /// Something is named with that probability that is not there.
  bool IsWrongAbove(double probability) const;
};

/// Files of a case are kept nowhere: the same seed is the same case.
HiddenOutcome RunHidden(const Machine& model, const HiddenPlan& plan,
                        std::uint64_t seed);

}  // namespace mjdiag
