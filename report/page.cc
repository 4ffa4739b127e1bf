#include "mjdiag/report/page.h"

namespace mjdiag {
namespace {

const char* ToneName(Tone tone) {
  switch (tone) {
    case Tone::kBad:
      return "bad";
    case Tone::kNeutral:
      return "neutral";
    case Tone::kGood:
      return "good";
  }
  return "";
}

nlohmann::json Pairs(const std::vector<std::pair<std::string, std::string>>& pairs) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [name, value] : pairs) {
    rows.push_back(nlohmann::json::array({name, value}));
  }
  return rows;
}

}  // namespace

Page::Page(std::string title)
    : document_{{"schema", "mjdiag.page/1"},
                {"title", std::move(title)},
                {"verdict", nullptr},
                {"command", ""},
                {"versions", nlohmann::json::array()},
                {"blocks", nlohmann::json::array()}} {}

void Page::SetVerdict(Tone tone, const std::string& text) {
  document_["verdict"] = {{"tone", ToneName(tone)}, {"text", text}};
}

void Page::SetRun(const RunDescription& run) {
  document_["command"] = run.command;
  document_["versions"] = Pairs(run.versions);
}

void Page::AddHeading(const std::string& text) {
  AddBlock({{"kind", "heading"}, {"text", text}});
}

void Page::AddParagraph(const std::string& text) {
  AddBlock({{"kind", "paragraph"}, {"text", text}});
}

void Page::AddFacts(const std::vector<std::pair<std::string, std::string>>& facts) {
  AddBlock({{"kind", "facts"}, {"rows", Pairs(facts)}});
}

void Page::AddTable(const Table& table) {
  nlohmann::json columns = nlohmann::json::array();
  for (const Table::Column& column : table.columns) {
    columns.push_back({{"title", column.title}, {"number", column.number}});
  }
  AddBlock({{"kind", "table"}, {"columns", columns}, {"rows", table.rows}});
}

void Page::AddCode(const std::string& text) {
  AddBlock({{"kind", "code"}, {"text", text}});
}

void Page::AddBlock(nlohmann::json block) {
  document_["blocks"].push_back(std::move(block));
}

}  // namespace mjdiag
