#pragma once
// What a page is behind its class: a JSON document, and how it is read from a file.

#include <filesystem>
#include <nlohmann/json.hpp>

namespace mjdiag {

/// Schema in page.h.
struct PageDocument {
  nlohmann::json json;
};

/// A page as its file has it, ready for a report. InputError with the file and the
/// place in it: not readable, not JSON (half-written), another schema, a missing or
/// misshapen part.
nlohmann::json ReadPageDocument(const std::filesystem::path& file);

}  // namespace mjdiag
