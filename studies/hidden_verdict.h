#pragma once
// What an answer of discovery is worth beside the truth.
//
//   right      all that is hidden is named, or what no measurement tells from it, and
//              nothing else
//   undecided  else, if every cause is named or given with 5 % at least as what a named
//              one may be instead, and nothing is named that is neither
//   wrong      something is named that is neither
//   silent     nothing is, but part of the truth is missing
//
// Of a law that no list has, no name is right; one of its family at its joint is as near
// as a name can be.

#include <utility>
#include <vector>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

// A force without a name (FoundCause::unnamed) is no name, right or wrong: beside the right
// names the answer is undecided, in the place of one silent.
enum class HiddenVerdict { kRight, kUndecided, kWrong, kSilent };
const char* WordOf(HiddenVerdict verdict);

HiddenVerdict VerdictOf(const std::vector<Cause>& truth,
                        const std::vector<FoundCause>& found);

enum class OutsideVerdict {
  kNothing,  ///< no name above 0.5; a force without one is none
  kFamily,   ///< names above 0.5, all of its family at its joint
  kFalse     ///< others
};
const char* WordOf(OutsideVerdict verdict);

/// @param law    the hidden one, at `joint` (nq index)
/// @param found  and the joints that they act on
OutsideVerdict VerdictOf(const Effect& law, Eigen::Index joint,
                         const std::vector<FoundCause>& found,
                         const std::vector<Eigen::Index>& joints);

/// A cause that was named, with what it was said to be worth.
struct Claim {
  double probability = 0.0;
  bool holds = false;  ///< it is there, or what no measurement tells from it
};
std::vector<Claim> ClaimsOf(const std::vector<Cause>& truth,
                            const std::vector<FoundCause>& found);

/// The same of kinds of physics at sites, whichever their laws. Numbers of the plant that are
/// others than the model says are off in every case: they are no claims.
std::vector<Claim> ClaimsOf(const std::vector<Cause>& truth,
                            const std::vector<FoundKind>& kinds);
/// Whether the kind of every cause is named at its site, and rather there than not.
bool HasKindsOf(const std::vector<Cause>& truth, const std::vector<FoundKind>& kinds);

/// Claims of about that probability: as many of them should hold.
struct ReliabilityBin {
  double from = 0.0;  ///< the first bin has its lower end in it, all have their upper
  double to = 0.0;
  int claims = 0;
  int hold = 0;
  double mean = 0.0;                  ///< of their probabilities
  std::pair<double, double> interval  ///< 95 % of Clopper and Pearson, of the share
      = {0.0, 1.0};                   ///< that holds
};
/// Bins that have claims, from 0 to 1.
std::vector<ReliabilityBin> ReliabilityOf(const std::vector<Claim>& claims);

}  // namespace mjdiag
