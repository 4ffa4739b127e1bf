// What stands behind the options of the command: faults, effects, addresses, units, limits
// and changes of the setup.
//
// Input: a byte that chooses the grammar, then words with bytes 0 between them.

#include <cmath>
#include <vector>

#include "fuzz/target.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/late_faults.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/signals/unit.h"
#include "mjdiag/watch/stream/address.h"

namespace mjdiag::fuzz {
namespace {

const Machine& Stage() {
  static const Machine stage(ReadSetup(Folder()));
  return stage;
}

void OfFault(std::string_view word) {
  const LateFault fault = ParseLateFault(word);
  StagesOf(Stage(), std::vector{fault});
}

void OfEffect(std::string_view word) {
  const PlacedEffect effect = ParseEffect(word);
  MustDo("an effect as text", [&] {
    Require(ParseEffect(FormatEffect(effect)) == effect,
            "an effect that comes back as another one");
  });
  Stage().With({{}, {effect}});
}

void OfAddress(std::string_view word) {
  const StreamAddress address = ParseStreamAddress(word, "--source");
  if (address.kind == StreamAddress::Kind::kProcess) return;
  const std::string text = AddressText(address);
  MustDo("an address as text", [&] {
    const StreamAddress again = ParseStreamAddress(text, "--source");
    Require(again.kind == address.kind && again.host == address.host &&
                again.port == address.port && again.topic == address.topic,
            "an address that comes back as another one");
  });
}

void OfUnit(std::string_view word) {
  const Unit unit = ParseUnit(word);
  Require(std::isfinite(unit.factor) && unit.factor > 0.0, "a unit without a size");
  MustDo("a unit of SI", [&] {
    Require(ParseUnit(unit.si) == Unit{1.0, unit.si}, "an SI unit that is none");
  });
  FormatQuantity(1.5, unit.si);
}

void OfNumber(std::string_view word) {
  const auto number = ParseNumber(word);
  if (!number || std::isnan(*number)) return;
  Require(ParseNumber(AllDigits(*number)) == number,
          "a number that comes back as another one");
  FormatQuantity(*number, "m");
}

void OfAssignments(std::string_view word) {
  ParseAssignments(word, [](const std::string& what) {
    throw InputError("--limit", what, "<name>=<number>");
  });
}

}  // namespace

void FuzzOptions(Input input) {
  Choices choices(input);
  const std::size_t grammar = choices.Below(8);
  std::vector<std::string> words;
  while (!choices.empty()) words.emplace_back(choices.Word());
  if (grammar == 0) {
    Done([&] { ReadSetup(Folder(), words); });
    return;
  }
  for (const std::string& word : words) {
    Done([&] {
      switch (grammar) {
        case 1:
          return OfFault(word);
        case 2:
          return OfEffect(word);
        case 3:
          return OfAddress(word);
        case 4:
          return OfUnit(word);
        case 5:
          return OfNumber(word);
        case 6:
          return OfAssignments(word);
        default:
          ParseHostPort(word, 0, "--listen");
          ParseHostPort(word, 8377, "--listen");
      }
    });
  }
}

}  // namespace mjdiag::fuzz
