#pragma once
// A case of the hard benchmark (hard_case.h), looked for by discovery as the command does
// it by default: numbers of the plant in doubt, 120 seconds of work.

#include <cstdint>
#include <optional>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/studies/hard_case.h"
#include "mjdiag/studies/hard_outcome.h"

namespace mjdiag {

struct HardOutcome {
  HardPlan plan;
  std::vector<Cause> truth;
  std::size_t fitted = 1;  ///< records
  std::size_t unseen = 0;  ///< of which nothing is fitted to
  Discovery answer;
  HardVerdict verdict = HardVerdict::kRight;  ///< of the catalogue, or of nothing
  OutsideVerdict outside = OutsideVerdict::kNothing;  ///< of an outside law
  std::vector<Claim> claims;
  std::vector<Claim> kind_claims;
  bool kinds_are_there = false;  ///< HasKindsOf
  /// Root mean square of what free simulation of a motion that no fit saw is off, over
  /// noise, all sensors: beside the model and beside the extended one.
  double before = 0.0;
  double after = 0.0;
  double seconds = 0.0;  ///< of the discovery, on this machine

  /// That anything is there, with or without a name.
  bool IsClaim() const;
  /// Something is named with that probability that is not there.
  bool IsWrongAbove(double probability) const;
};

/// Files of a case are kept nowhere: the same seed is the same case.
HardOutcome RunHard(const Machine& model, const HardPlan& plan, std::uint64_t seed);

}  // namespace mjdiag
