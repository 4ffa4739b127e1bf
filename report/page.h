#pragma once
// One self-contained HTML page: no network, no second file. Text, tables and plots are
// appended in reading order, and Html() gives the finished page. It follows the
// reader's light or dark scheme, fits a phone and prints.
//
// All text that goes in is plain text: it is escaped here and nowhere else.

#include <string>
#include <utility>
#include <vector>

#include "mjdiag/report/plot.h"

namespace mjdiag {

/// How the verdict of a run looks: the mark next to it, never the colour alone.
enum class Tone { kGood, kBad, kNeutral };

/// A table; every row has as many cells as there are columns.
struct Table {
  struct Column {
    std::string title;
    bool number = false;  ///< right-aligned
  };
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;
};

class Page {
 public:
  /// @param title  of the page and its first heading
  explicit Page(std::string title);

  /// The answer in one sentence.
  void AddVerdict(Tone tone, const std::string& text);
  void AddHeading(const std::string& text);
  void AddParagraph(const std::string& text);
  /// Name and value pairs.
  void AddFacts(const std::vector<std::pair<std::string, std::string>>& facts);
  void AddTable(const Table& table);
  /// A command line or other text to be copied as it is.
  void AddCode(const std::string& text);
  /// All time plots of a page zoom and show their cursor together.
  void AddPlot(const TimePlot& plot);
  void AddPlot(const SpectrumPlot& plot);
  void AddPlot(const XyPlot& plot);
  void AddPlot(const HistogramPlot& plot);
  void AddPlot(const BodePlot& plot);

  /// The page. InputError if the plot library is not installed.
  std::string Html() const;

 private:
  void AddPlotElement(const std::string& caption, int height,
                      const std::string& description);

  std::string title_;
  std::string body_;
  bool has_plots_ = false;
};

}  // namespace mjdiag
