#pragma once
// Whole text files: read at once, written under a temporary name and renamed.

#include <filesystem>
#include <string>
#include <string_view>

namespace mjdiag {

/// The file's bytes. InputError if it cannot be read or is a folder.
std::string ReadTextFile(const std::filesystem::path& file);

/// Replaces `file` by `text` in one step: readers see the old file or the new one.
/// InputError if the folder is missing or not writable.
void WriteTextFile(const std::filesystem::path& file, std::string_view text);

/// Makes `folder` (and its parents) and proves that it can be written to.
/// InputError otherwise. Call before any long computation.
void MakeOutputFolder(const std::filesystem::path& folder);

}  // namespace mjdiag
