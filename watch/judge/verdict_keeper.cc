#include "mjdiag/watch/judge/verdict_keeper.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

Verdict VerdictOf(const Finding& look) {
  Verdict verdict;
  verdict.kind = look.kind;
  verdict.words = look.words;
  verdict.since = verdict.last = look.time;
  if (look.kind != VerdictKind::kFault) return verdict;
  for (const FaultVerdict& fault : RankedFaults(look.result)) {
    if (!fault.detected) continue;
    verdict.faults.push_back(fault);
    verdict.names.push_back(fault.name);
  }
  std::ranges::sort(verdict.names);
  return verdict;
}

bool IsHealthy(const Verdict& verdict) { return verdict.kind == VerdictKind::kHealthy; }
bool IsNone(const Verdict& verdict) { return verdict.kind == VerdictKind::kSettling; }

}  // namespace

std::optional<VerdictChange> VerdictKeeper::Take(const Finding& look) {
  if (look.kind == VerdictKind::kSettling) return std::nullopt;
  Verdict seen = VerdictOf(look);
  if (now_.SameAs(seen)) {
    next_.reset();
    now_.words = std::move(seen.words);
    now_.faults = std::move(seen.faults);
    now_.last = seen.last;
    return std::nullopt;
  }
  if (!next_ || !next_->SameAs(seen)) {
    next_ = seen;
  } else {
    seen.since = next_->since;
    next_ = seen;
  }
  const double stood = look.time - next_->since;
  const double needed = IsNone(now_)        ? 0.0
                        : IsHealthy(*next_) ? options_.better
                                            : options_.worse;
  // A clock that was set back must not keep a verdict from being told.
  if (stood >= 0.0 && stood < needed) return std::nullopt;
  VerdictChange change{now_, *std::exchange(next_, std::nullopt)};
  if (IsHealthy(change.now)) {
    change.now.wrong_since = 0.0;
  } else {
    const bool was_wrong = !IsNone(now_) && !IsHealthy(now_);
    change.now.wrong_since = was_wrong ? now_.wrong_since : change.now.since;
  }
  now_ = change.now;
  return change;
}

nlohmann::json ToJson(const Verdict& verdict) {
  nlohmann::json faults = nlohmann::json::array();
  for (const FaultVerdict& fault : verdict.faults) {
    faults.push_back({{"name", fault.name},
                      {"value", fault.value},
                      {"sd", fault.sd},
                      {"ci95", {fault.ci95.min, fault.ci95.max}}});
  }
  return {{"kind", NameOf(verdict.kind)}, {"words", verdict.words},
          {"since", verdict.since},       {"wrong_since", verdict.wrong_since},
          {"last", verdict.last},         {"faults", faults}};
}

Verdict VerdictFromJson(const nlohmann::json& json) {
  try {
    Verdict verdict;
    verdict.kind = VerdictKindOf(json.at("kind"));
    verdict.words = json.at("words");
    verdict.since = json.at("since");
    verdict.wrong_since = json.at("wrong_since");
    verdict.last = json.at("last");
    for (const nlohmann::json& fault : json.at("faults")) {
      FaultVerdict named;
      named.name = fault.at("name");
      named.value = fault.at("value");
      named.sd = fault.at("sd");
      named.ci95 = {fault.at("ci95").at(0), fault.at("ci95").at(1)};
      named.detected = true;
      verdict.names.push_back(named.name);
      verdict.faults.push_back(std::move(named));
    }
    std::ranges::sort(verdict.names);
    return verdict;
  } catch (const nlohmann::json::exception& error) {
    throw InputError("verdict", error.what(), "one as the watch writes it");
  }
}

}  // namespace mjdiag
