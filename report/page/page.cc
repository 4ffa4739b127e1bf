#include "mjdiag/report/page/page.h"

#include "mjdiag/report/page/page_document.h"
#include "mjdiag/report/page/plot_json.h"

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

void AddBlock(PageDocument& page, nlohmann::json block) {
  page.json["blocks"].push_back(std::move(block));
}

template <typename Plot>
nlohmann::json PlotBlock(const Plot& plot) {
  return {{"kind", "plot"}, {"caption", plot.caption}, {"plot", DescribePlot(plot)}};
}

}  // namespace

Page::Page(std::string title)
    : document_(std::make_unique<PageDocument>(
          PageDocument{{{"schema", "mjdiag.page/1"},
                        {"title", std::move(title)},
                        {"verdict", nullptr},
                        {"command", ""},
                        {"versions", nlohmann::json::array()},
                        {"blocks", nlohmann::json::array()}}})) {}
Page::~Page() = default;
Page::Page(Page&&) noexcept = default;
Page& Page::operator=(Page&&) noexcept = default;

void Page::SetVerdict(Tone tone, const std::string& text) {
  document_->json["verdict"] = {{"tone", ToneName(tone)}, {"text", text}};
}

void Page::SetRun(const RunDescription& run) {
  document_->json["command"] = run.command;
  document_->json["versions"] = Pairs(run.versions);
}

void Page::AddHeading(const std::string& text) {
  AddBlock(*document_, {{"kind", "heading"}, {"text", text}});
}

void Page::AddParagraph(const std::string& text) {
  AddBlock(*document_, {{"kind", "paragraph"}, {"text", text}});
}

void Page::AddFacts(const std::vector<std::pair<std::string, std::string>>& facts) {
  AddBlock(*document_, {{"kind", "facts"}, {"rows", Pairs(facts)}});
}

void Page::AddTable(const Table& table) {
  nlohmann::json columns = nlohmann::json::array();
  for (const Table::Column& column : table.columns) {
    columns.push_back({{"title", column.title}, {"number", column.number}});
  }
  AddBlock(*document_, {{"kind", "table"}, {"columns", columns}, {"rows", table.rows}});
}

void Page::AddCode(const std::string& text) {
  AddBlock(*document_, {{"kind", "code"}, {"text", text}});
}

void Page::AddPlot(const TimePlot& plot) { AddBlock(*document_, PlotBlock(plot)); }
void Page::AddPlot(const SpectrumPlot& plot) { AddBlock(*document_, PlotBlock(plot)); }
void Page::AddPlot(const XyPlot& plot) { AddBlock(*document_, PlotBlock(plot)); }
void Page::AddPlot(const HistogramPlot& plot) { AddBlock(*document_, PlotBlock(plot)); }
void Page::AddPlot(const BodePlot& plot) { AddBlock(*document_, PlotBlock(plot)); }

}  // namespace mjdiag
