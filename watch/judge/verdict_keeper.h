#pragma once
// The verdict that people are told: it changes when another one has stood for a moment,
// and is not lost when the diagnosis begins anew.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/watch/judge/finding.h"

namespace mjdiag {

struct Verdict {
  VerdictKind kind = VerdictKind::kSettling;
  std::vector<std::string> names;  ///< of the faults that are named, sorted
  std::string words;               ///< as of the last look that said it
  double since = 0.0;              ///< that it is said [s since 1970]
  /// That something is wrong, whatever it was said to be [s since 1970]; 0: nothing is.
  double wrong_since = 0.0;
  double last = 0.0;                 ///< look that said it [s since 1970]
  std::vector<FaultVerdict> faults;  ///< those that are named, as of that look

  bool SameAs(const Verdict& other) const {
    return kind == other.kind && names == other.names;
  }
};

struct VerdictChange {
  Verdict before;  ///< kSettling: none yet
  Verdict now;
};

/// {"kind", "words", "since", "wrong_since", "last", "faults": [...]} for pages, files and
/// other programs; times in seconds since 1970.
nlohmann::json ToJson(const Verdict& verdict);
/// InputError on what ToJson does not make.
Verdict VerdictFromJson(const nlohmann::json& json);

struct KeeperOptions {
  double worse = 0.3;   ///< [s] that another verdict has to stand
  double better = 3.0;  ///< [s] that nothing has to be wrong
};

class VerdictKeeper {
 public:
  explicit VerdictKeeper(const KeeperOptions& options = {}) : options_(options) {}

  /// Goes on with what was said before it was made.
  void Resume(const Verdict& verdict) { now_ = verdict; }

  /// What a look says; the change if it makes one.
  std::optional<VerdictChange> Take(const Finding& look);

  /// kSettling as long as there is none.
  const Verdict& now() const { return now_; }

 private:
  KeeperOptions options_;
  Verdict now_;
  std::optional<Verdict> next_;  // that has to stand for a moment
};

}  // namespace mjdiag
