#pragma once
// The plotting library that pages carry with them: dygraphs (MIT), as Debian's
// libjs-dygraphs installs it.

#include <string>

namespace mjdiag {

struct PlotLibrary {
  std::string script;  ///< dygraphs
  std::string style;
};

/// Reads the installed library. InputError says which file is missing and which package
/// has it.
PlotLibrary LoadPlotLibrary();

}  // namespace mjdiag
