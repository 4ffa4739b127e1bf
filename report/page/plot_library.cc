#include "mjdiag/report/page/plot_library.h"

#include <array>
#include <filesystem>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// Where the library may lie: where the build found it, then the usual places.
fs::path LibraryFolder() {
  const std::array<fs::path, 3> folders = {MJDIAG_DYGRAPHS_FOLDER,
                                           "/usr/share/javascript/dygraphs",
                                           "/usr/local/share/javascript/dygraphs"};
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / "dygraph.min.js")) return folder;
  }
  throw InputError(folders[1] / "dygraph.min.js", "the plot library is not installed",
                   "the files of the package libjs-dygraphs");
}

/// The file without its reference to a source map, which is another file.
std::string ReadWithoutSourceMap(const fs::path& file) {
  std::string text = ReadTextFile(file);
  const auto map = text.rfind("# sourceMappingURL=");
  if (map == std::string::npos) return text;
  const auto comment = text.rfind('/', map);  // "//#" in a script, "/*#" in a style
  text.resize(text[comment - 1] == '/' ? comment - 1 : comment);
  return text;
}

}  // namespace

PlotLibrary LoadPlotLibrary() {
  const fs::path folder = LibraryFolder();
  return {ReadWithoutSourceMap(folder / "dygraph.min.js"),
          ReadWithoutSourceMap(folder / "dygraph.min.css")};
}

}  // namespace mjdiag
