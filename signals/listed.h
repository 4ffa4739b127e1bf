#pragma once
// Names in a sentence.

#include <string>
#include <vector>

namespace mjdiag {

/// "x, y, z"; of none: "".
inline std::string Listed(const std::vector<std::string>& names,
                          const std::string& between = ", ") {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : between) + name;
  return text;
}

}  // namespace mjdiag
