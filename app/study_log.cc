#include "app/study_log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "app/format.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::app {
namespace {

using nlohmann::json;

json ToJson(const Cell& cell) {
  if (!cell.is_number) return cell.text;
  return std::isfinite(cell.number) ? json(cell.number) : json();
}

json ToJson(const StudyTable& table) {
  json rows = json::array();
  for (const auto& cells : table.rows) {
    json row = json::array();
    for (const Cell& cell : cells) row.push_back(ToJson(cell));
    rows.push_back(row);
  }
  return {{"title", table.title},
          {"columns", table.columns},
          {"rows", std::move(rows)},
          {"notes", table.notes}};
}

std::vector<std::string> TextsOf(const std::vector<Cell>& cells) {
  std::vector<std::string> texts;
  texts.reserve(cells.size());
  for (const Cell& cell : cells) texts.push_back(cell.text);
  return texts;
}

std::string ToText(const StudyTable& table) {
  Table text(table.columns);
  for (const auto& cells : table.rows) text.Add(TextsOf(cells));
  std::string result = table.title + "\n\n" + text.ToString();
  for (const std::string& note : table.notes) result += "\n" + note;
  return result + (table.notes.empty() ? "\n" : "\n\n");
}

}  // namespace

StudyLog::StudyLog(const OutputOptions& output, json document, const std::string& label)
    : output_(output), document_(std::move(document)), bar_(label) {}

void StudyLog::Progress(double fraction) {
  const std::lock_guard lock(mutex_);
  bar_.Show(fraction);
}

void StudyLog::Show(const StudyTable& table) {
  const std::lock_guard lock(mutex_);
  if (shown_.empty() || shown_.back().title != table.title) {
    shown_.push_back(table);
    shown_.back().rows.clear();
  }
  if (!output_.json) Print(table);
  shown_.back() = table;
  if (output_.folder.empty()) return;
  WriteTextFile(
      std::filesystem::path(output_.folder) / "study.json",
      Document(shown_, false).dump(2, ' ', false, json::error_handler_t::replace) +
          "\n");
}

void StudyLog::Print(const StudyTable& table) {
  bar_.Wipe();
  const std::size_t printed = shown_.back().rows.size();
  std::string text;
  if (printed == 0) {
    constexpr std::size_t kNumber = 10;  // characters of one
    widths_.assign(table.columns.size(), kNumber);
    Widen(table.columns, widths_);
    text = (shown_.size() > 1 ? "\n" : "") + table.title + "\n\n";
    for (const std::string& note : table.notes) text += note + "\n";
    text += (table.notes.empty() ? "" : "\n") + Line(table.columns, widths_);
  }
  for (std::size_t i = printed; i < table.rows.size(); ++i) {
    const std::vector<std::string> cells = TextsOf(table.rows[i]);
    Widen(cells, widths_);
    text += Line(cells, widths_);
  }
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

json StudyLog::Document(const std::vector<StudyTable>& tables, bool finished) const {
  json document = document_;
  document["finished"] = finished;
  document["tables"] = json::array();
  for (const StudyTable& table : tables) document["tables"].push_back(ToJson(table));
  return document;
}

std::string StudyLog::RestOf(const std::vector<StudyTable>& tables) {
  const std::lock_guard lock(mutex_);
  bar_.Wipe();
  std::string text = shown_.empty() || output_.json ? "" : "\n";
  for (const StudyTable& table : tables) {
    if (table.columns.empty()) continue;  // a plot, for the page
    const bool shown =
        std::any_of(shown_.begin(), shown_.end(),
                    [&](const StudyTable& s) { return s.title == table.title; });
    if (!shown) text += ToText(table);
  }
  return text;
}

}  // namespace mjdiag::app
