#include "mjdiag/report/kinds_text.h"

#include <vector>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

/// Neither certain nor nothing: "> 99.9 %", "< 0.1 %".
std::string PartText(double share) {
  constexpr double kLeast = 1e-3;
  if (share < kLeast) return "< 0.1 %";
  if (share > 1.0 - kLeast) return "> 99.9 %";
  return FormatNumber(100.0 * share, 3) + " %";
}

std::string SureText(double probability) {
  constexpr double kCertain = 0.99;
  constexpr double kLikely = 0.8;
  if (probability >= kCertain) return "all but certain";
  return probability >= kLikely ? "likely" : "possible";
}

}  // namespace

std::string KindAt(const FoundKind& found) {
  return KindName(found.kind) + " at " + found.site;
}

std::string KindWords(const FoundKind& found) {
  return KindAt(found) + ", " + KindMeaning(found.kind) + ": " +
         SureText(found.probability);
}

std::string KindsSentence(const Discovery& discovery) {
  constexpr double kRather = 0.5;
  std::vector<std::string> there;
  for (const FoundKind& found : discovery.kinds) {
    if (found.probability < kRather) continue;
    there.push_back(KindAt(found) + " (" + KindMeaning(found.kind) + ")");
  }
  if (there.empty()) return "";
  std::string text = "The model is wrong about ";
  for (std::size_t i = 0; i < there.size(); ++i) {
    const bool last = i + 1 == there.size();
    text += (i == 0 ? "" : last ? " and " : ", ") + there[i];
  }
  return text + ". ";
}

Table KindTable(const Discovery& discovery) {
  Table table;
  table.columns = {{"Kind of physics"},
                   {"Site"},
                   {"Probability", true},
                   {"Mismatch back without it", true},
                   {"What it is"}};
  for (const FoundKind& found : discovery.kinds) {
    table.rows.push_back({KindName(found.kind), found.site, PartText(found.probability),
                          found.of_number ? "-" : PartText(found.share),
                          KindMeaning(found.kind)});
  }
  return table;
}

}  // namespace mjdiag
