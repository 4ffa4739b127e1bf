#include "mjdiag/studies/hidden_verdict.h"

#include <algorithm>
#include <array>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {
namespace {

constexpr double kLikely = 0.5;

bool MayBe(const FoundCause& found, const Cause& truth) {
  constexpr double kCompetes = 0.05;
  return std::ranges::any_of(found.alternatives, [&](const Alternative& other) {
    return other.probability >= kCompetes && Indistinguishable(other.cause, truth);
  });
}

bool IsOf(const FoundKind& kind, const Cause& cause) {
  return kind.kind == cause.effect->kind() && kind.site == cause.site;
}

/// Takes one that `matches` out of the list; false if none does.
template <typename Matches>
bool TakeOut(std::vector<Cause>& causes, const Matches& matches) {
  const auto found = std::ranges::find_if(causes, matches);
  if (found == causes.end()) return false;
  causes.erase(found);
  return true;
}

}  // namespace

const char* WordOf(HiddenVerdict verdict) {
  switch (verdict) {
    case HiddenVerdict::kRight:
      return "right";
    case HiddenVerdict::kUndecided:
      return "undecided";
    case HiddenVerdict::kWrong:
      return "wrong";
    case HiddenVerdict::kSilent:
      return "silent";
  }
  return "";
}

const char* WordOf(OutsideVerdict verdict) {
  switch (verdict) {
    case OutsideVerdict::kNothing:
      return "no name";
    case OutsideVerdict::kFamily:
      return "its family";
    case OutsideVerdict::kFalse:
      return "false name";
  }
  return "";
}

// Every cause of the truth excuses one that is named.
HiddenVerdict VerdictOf(const std::vector<Cause>& truth,
                        const std::vector<FoundCause>& found) {
  std::vector<Cause> missing = truth;
  std::vector<const FoundCause*> others;
  bool has_unnamed = false;
  for (const FoundCause& one : found) {
    has_unnamed |= !one.HasName();
    if (!one.HasName()) continue;
    const bool named = TakeOut(missing, [&](const Cause& cause) {
      return Indistinguishable(one.cause, cause);
    });
    if (!named) others.push_back(&one);
  }
  if (missing.empty() && others.empty()) {
    return has_unnamed ? HiddenVerdict::kUndecided : HiddenVerdict::kRight;
  }
  for (const FoundCause* one : others) {
    if (!TakeOut(missing, [&](const Cause& cause) { return MayBe(*one, cause); })) {
      return HiddenVerdict::kWrong;
    }
  }
  return missing.empty() ? HiddenVerdict::kUndecided : HiddenVerdict::kSilent;
}

OutsideVerdict VerdictOf(const Effect& law, Eigen::Index joint,
                         const std::vector<FoundCause>& found,
                         const std::vector<Eigen::Index>& joints) {
  OutsideVerdict verdict = OutsideVerdict::kNothing;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].probability <= kLikely || !found[i].HasName()) continue;
    const bool near =
        found[i].cause.effect->family() == law.family() && joints[i] == joint;
    if (!near) return OutsideVerdict::kFalse;
    verdict = OutsideVerdict::kFamily;
  }
  return verdict;
}

std::vector<Claim> ClaimsOf(const std::vector<Cause>& truth,
                            const std::vector<FoundCause>& found) {
  std::vector<Cause> left = truth;
  std::vector<Claim> claims;
  for (const FoundCause& one : found) {
    if (!one.HasName()) continue;
    claims.push_back({one.probability, TakeOut(left, [&](const Cause& cause) {
                        return Indistinguishable(one.cause, cause);
                      })});
  }
  return claims;
}

std::vector<Claim> ClaimsOf(const std::vector<Cause>& truth,
                            const std::vector<FoundKind>& kinds) {
  std::vector<Claim> claims;
  for (const FoundKind& kind : kinds) {
    if (kind.of_number) continue;
    claims.push_back({kind.probability,
                      std::ranges::any_of(
                          truth, [&](const Cause& one) { return IsOf(kind, one); })});
  }
  return claims;
}

bool HasKindsOf(const std::vector<Cause>& truth, const std::vector<FoundKind>& kinds) {
  return std::ranges::all_of(truth, [&](const Cause& cause) {
    return std::ranges::any_of(kinds, [&](const FoundKind& kind) {
      return kind.probability > kLikely && IsOf(kind, cause);
    });
  });
}

std::vector<ReliabilityBin> ReliabilityOf(const std::vector<Claim>& claims) {
  constexpr std::array kEnds = {0.0, 0.5, 0.7, 0.9, 0.99, 1.0};
  std::vector<ReliabilityBin> bins;
  for (std::size_t i = 0; i + 1 < kEnds.size(); ++i) {
    ReliabilityBin bin{kEnds[i], kEnds[i + 1]};
    for (const Claim& claim : claims) {
      const bool above = claim.probability > bin.from || i == 0;
      if (!above || claim.probability > bin.to) continue;
      ++bin.claims;
      bin.hold += claim.holds ? 1 : 0;
      bin.mean += claim.probability;
    }
    if (bin.claims == 0) continue;
    bin.mean /= bin.claims;
    bin.interval = ProbabilityInterval(bin.claims, bin.hold, 0.95);
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace mjdiag
