#pragma once
// Replacements in a text, collected by position and made all at once, so that positions
// are those of the original throughout.

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace mjdiag {

class TextChanges {
 public:
  /// Puts `text` in place of [begin, end). Replacements must not overlap; insertions at
  /// one place keep their order.
  void Replace(std::size_t begin, std::size_t end, std::string text) {
    changes_.push_back({begin, end, std::move(text)});
  }

  std::string Apply(const std::string& original) const {
    std::vector<Change> ordered = changes_;
    std::stable_sort(
        ordered.begin(), ordered.end(),
        [](const Change& a, const Change& b) { return a.begin < b.begin; });
    std::string text;
    std::size_t done = 0;
    for (const Change& change : ordered) {
      text.append(original, done, change.begin - done).append(change.text);
      done = change.end;
    }
    return text.append(original, done);
  }

 private:
  struct Change {
    std::size_t begin;
    std::size_t end;
    std::string text;
  };
  std::vector<Change> changes_;
};

}  // namespace mjdiag
