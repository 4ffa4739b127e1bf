#pragma once
// TOML as text, before it is parsed: toml++ 3.3 takes for granted that some things do not
// occur, and what it does where they do is undefined. They are no TOML either.

#include <optional>
#include <string>
#include <string_view>

namespace mjdiag {

/// Why a text is no TOML.
struct TomlTrouble {
  int line = 1;
  std::string what;
};

/// Characters beyond ASCII that stand neither in quotes nor in a comment, or behind a
/// backslash that breaks a line; control characters; quotation marks and brackets within
/// values; brackets that close another one; dates with half a time; [tables] that begin with
/// something else than a name. None of them: nothing.
std::optional<TomlTrouble> FindTomlTrouble(std::string_view text);

}  // namespace mjdiag
