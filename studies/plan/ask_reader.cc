#include "mjdiag/studies/plan/ask_reader.h"

#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

constexpr int kMostAsked = 1'000'000;
constexpr double kLongest = 1e7;  // [s]
constexpr NumberRule kFraction{[](double x) { return x >= 0.0 && x <= 1.0; },
                               "a share from 0 to 1"};
constexpr NumberRule kAboveOne{[](double x) { return x > 1.0; }, "a factor > 1"};
constexpr NumberRule kTime{[](double x) { return x > 0.0 && x <= kLongest; },
                           "seconds above 0, at most 1e7"};

// Every question reads the keys that it has.

template <typename Ask>
void ReadKeys(const TomlTable&, Ask&) {}

template <>
void ReadKeys(const TomlTable& table, AskSmallestSize& ask) {
  ask.judges = table.Texts("judges", ask.judges);
  for (const std::string& name : ask.judges) {
    RequireDeclared(table, "judges", name, "judge", kJudges);
  }
  ask.baseline = table.Flag("baseline", ask.baseline);
  ask.limits_from = table.Integer("limits_from", 0, kMostAsked, ask.limits_from);
  ask.seeds = table.Integer("seeds", 1, kMostAsked, ask.seeds);
  ask.resolution = table.Number("resolution", kAboveOne, ask.resolution);
  ask.delays = table.Flag("delays", ask.delays);
}

template <>
void ReadKeys(const TomlTable& table, AskNames& ask) {
  ask.healthy = table.Number("healthy", kFraction, ask.healthy);
  ask.most = table.Integer("most", 1, kMostAsked, ask.most);
  ask.from_rest = table.Number("from_rest", kFraction, ask.from_rest);
}

template <>
void ReadKeys(const TomlTable& table, AskCalibration& ask) {
  ask.learned_from = table.Integer("learned_from", 1, kMostAsked, ask.learned_from);
  ask.judged = table.Integer("judged", 1, kMostAsked, ask.judged);
  ask.promised = table.Number("promised", kAboveOne, ask.promised);
}

template <>
void ReadKeys(const TomlTable& table, AskEndurance& ask) {
  ask.duration = table.Number("duration", kTime, ask.duration);
  ask.every = table.Number("every", kTime, ask.every);
  ask.wear = table.TextNumbers("wear");
}

template <>
void ReadKeys(const TomlTable& table, AskHidden& ask) {
  ask.exact = table.Flag("exact", ask.exact);
  constexpr int kMostCauses = 3;
  if (ask.exact || table.Has("causes")) {
    ask.causes = table.Integer("causes", 0, kMostCauses);
  }
}

/// The question of that name out of those from `next` on.
template <std::size_t next = 0>
PlanAsk ReadNamed(const TomlTable& table, const std::string& name,
                  std::vector<std::string> others = {}) {
  if constexpr (next == std::variant_size_v<PlanAsk>) {
    table.Fail("question", "is '" + name + "'", "one of " + Listed(others));
  } else {
    std::variant_alternative_t<next, PlanAsk> ask;
    if (name == ask.kQuestion) {
      ReadKeys(table, ask);
      return ask;
    }
    others.emplace_back(ask.kQuestion);
    return ReadNamed<next + 1>(table, name, std::move(others));
  }
}

}  // namespace

PlanAsk ReadAsk(const TomlTable& table) {
  return ReadNamed(table, table.Text("question"));
}

}  // namespace mjdiag
