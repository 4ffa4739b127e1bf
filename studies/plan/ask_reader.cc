#include "mjdiag/studies/plan/ask_reader.h"

#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

// Every question reads the keys that it has.

void Read(const TomlTable&, AskBound&) {}

/// The question of that name out of those from `next` on.
template <std::size_t next = 0>
PlanAsk ReadNamed(const TomlTable& table, const std::string& name,
                  std::vector<std::string> others = {}) {
  if constexpr (next == std::variant_size_v<PlanAsk>) {
    table.Fail("question", "is '" + name + "'", "one of " + Listed(others));
  } else {
    std::variant_alternative_t<next, PlanAsk> ask;
    if (name == ask.kQuestion) {
      Read(table, ask);
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
