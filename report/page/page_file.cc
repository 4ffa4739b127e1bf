#include "mjdiag/report/page/page_file.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "mjdiag/report/page/base64.h"
#include "mjdiag/report/page/page_document.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

using nlohmann::json;

/// Says where in the document something is wrong.
class Checker {
 public:
  explicit Checker(std::string file) : file_(std::move(file)) {}

  void Document(const json& document) const {
    Require(document.is_object(), "", "an object");
    Require(document.value("schema", json()) == "mjdiag.page/1", "schema",
            "\"mjdiag.page/1\"");
    Text(document, "", "title");
    Text(document, "", "command");
    Rows(document, "", "versions", 2);
    Verdict(Part(document, "", "verdict"));
    const json& blocks = List(document, "", "blocks");
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      Block(blocks[i], "blocks[" + std::to_string(i) + "]");
    }
  }

 private:
  void Require(bool good, const std::string& place, const std::string& expected) const {
    if (good) return;
    throw InputError(
        file_, place.empty() ? "not a page" : "'" + place + "' is not right", expected);
  }
  static std::string Inside(const std::string& place, const std::string& key) {
    return place.empty() ? key : place + "." + key;
  }
  const json& Part(const json& object, const std::string& place,
                   const std::string& key) const {
    Require(object.is_object() && object.contains(key), Inside(place, key),
            "to be there");
    return object[key];
  }
  std::string_view Text(const json& object, const std::string& place,
                        const std::string& key) const {
    const json& part = Part(object, place, key);
    Require(part.is_string(), Inside(place, key), "a text");
    return part.get_ref<const std::string&>();
  }
  const json& List(const json& object, const std::string& place,
                   const std::string& key) const {
    const json& part = Part(object, place, key);
    Require(part.is_array(), Inside(place, key), "a list");
    return part;
  }
  void Rows(const json& object, const std::string& place, const std::string& key,
            std::size_t cells) const {
    for (const json& row : List(object, place, key)) {
      Require(row.is_array() && row.size() == cells, Inside(place, key),
              "rows of " + std::to_string(cells) + " cells");
      for (const json& cell : row) {
        Require(cell.is_string(), Inside(place, key), "cells of text");
      }
    }
  }

  void Verdict(const json& verdict) const {
    if (verdict.is_null()) return;
    Text(verdict, "verdict", "text");
    const std::string_view tone = Text(verdict, "verdict", "tone");
    Require(tone == "bad" || tone == "neutral" || tone == "good", "verdict.tone",
            "bad, neutral or good");
  }

  void Block(const json& block, const std::string& place) const {
    const std::string_view kind = Text(block, place, "kind");
    if (kind == "facts") {
      Rows(block, place, "rows", 2);
    } else if (kind == "table") {
      const json& columns = List(block, place, "columns");
      for (const json& column : columns) {
        Text(column, place, "title");
        Require(Part(column, place, "number").is_boolean(), place + ".number",
                "true or false");
      }
      Rows(block, place, "rows", columns.size());
    } else if (kind == "plot") {
      Text(block, place, "caption");
      Plot(Part(block, place, "plot"), Inside(place, "plot"));
    } else {
      Require(kind == "heading" || kind == "paragraph" || kind == "code",
              Inside(place, "kind"), "heading, paragraph, code, facts, table or plot");
      Text(block, place, "text");
    }
  }

  void Plot(const json& plot, const std::string& place) const {
    constexpr std::array<std::string_view, 5> kKinds = {"time", "spectrum", "xy",
                                                        "histogram", "bode"};
    const std::string_view kind = Text(plot, place, "kind");
    Require(std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end(),
            Inside(place, "kind"), "time, spectrum, xy, histogram or bode");
    Require(Part(plot, place, "height").is_number_integer(), Inside(place, "height"),
            "a number of pixels");
    List(plot, place, "curves");
    Samples(plot, place);
  }

  /// What the page's script decodes, wherever it is in a plot.
  void Samples(const json& part, const std::string& place) const {
    for (const auto& [key, value] : part.items()) {
      const bool samples = key == "samples" || key == "x" || key == "y" ||
                           key == "frequency" || key == "edges" || key == "counts";
      if (value.is_structured()) {
        Samples(value, Inside(place, key));
      } else if (samples) {
        Require(value.is_string() &&
                    IsBase64(value.get_ref<const std::string&>(), sizeof(float)),
                Inside(place, key), "32-bit floats in base64");
      }
    }
  }

  std::string file_;
};

}  // namespace

void WritePage(const std::filesystem::path& folder, const std::string& name,
               const Page& page) {
  WriteTextFile(
      folder / (name + kPageEnding),
      page.document().json.dump(-1, ' ', false, json::error_handler_t::replace));
}

json ReadPageDocument(const std::filesystem::path& file) {
  const std::string text = ReadTextFile(file);
  json document;
  try {
    document = json::parse(text);
  } catch (const json::parse_error& error) {
    throw InputError(
        file.string(),
        text.empty() ? "empty"
                     : "broken off or damaged at byte " + std::to_string(error.byte),
        "a page as mjdiag writes it");
  }
  Checker(file.string()).Document(document);
  return document;
}

}  // namespace mjdiag
