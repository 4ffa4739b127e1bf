#pragma once
// The page of a command: text, tables and plots in reading order, and how it was made.
// It is a document, which can be written to a file (page_file.h), from which a report is
// made (report.h), so that a report can be made anew, or of several commands, without
// running them again.
//
// All text that goes in is plain text.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/report/page/plot.h"
#include "mjdiag/report/page/run_description.h"

namespace mjdiag {

/// How the verdict of a run looks: the mark next to it, never the colour alone.
enum class Tone { kBad, kNeutral, kGood };

/// A table; every row has as many cells as there are columns.
struct Table {
  struct Column {
    std::string title;
    bool number = false;  ///< right-aligned
  };
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;
};

struct PageDocument;

/// Schema "mjdiag.page/1": title; verdict {tone: "bad", "neutral" or "good", text} or
/// null; command; versions [[program, version]]; blocks in reading order, each with a
/// kind:
///
///   heading, paragraph, code  text
///   facts                     rows [[name, value]]
///   table                     columns [{title, number}], rows [[text]]
///   plot                      caption, plot (plot_json.h)
class Page {
 public:
  /// @param title  of the page and its first heading
  explicit Page(std::string title);
  ~Page();
  Page(Page&& other) noexcept;
  Page& operator=(Page&& other) noexcept;

  /// The answer in one sentence; a later one takes the place of an earlier one.
  void SetVerdict(Tone tone, const std::string& text);
  /// How to do it again.
  void SetRun(const RunDescription& run);

  void AddHeading(const std::string& text);
  void AddParagraph(const std::string& text);
  /// Name and value pairs.
  void AddFacts(const std::vector<std::pair<std::string, std::string>>& facts);
  void AddTable(const Table& table);
  /// A command line or other text to be copied as it is.
  void AddCode(const std::string& text);
  /// All time plots of a report zoom and show their cursor together.
  void AddPlot(const TimePlot& plot);
  void AddPlot(const SpectrumPlot& plot);
  void AddPlot(const XyPlot& plot);
  void AddPlot(const HistogramPlot& plot);
  void AddPlot(const BodePlot& plot);

  /// What is in it so far (page_document.h).
  const PageDocument& document() const { return *document_; }

 private:
  std::unique_ptr<PageDocument> document_;
};

}  // namespace mjdiag
