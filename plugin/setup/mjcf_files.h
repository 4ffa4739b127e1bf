#pragma once
// MJCF that refers to other files.

#include <filesystem>
#include <string>

namespace mjdiag {

/// The text of an MJCF file as it can be loaded from `folder` instead of its own:
/// <include> elements are replaced by what they include (their files are relative to
/// that of the model, as in MuJoCo), and meshdir and texturedir lead to the old folder.
/// InputError if a file cannot be read or is not well-formed.
std::string MjcfForFolder(const std::filesystem::path& mjcf,
                          const std::filesystem::path& folder);
/// The same of a text without includes that can be loaded from `own`.
/// @param where  what complaints call it
std::string MjcfForFolder(const std::string& where, std::string text,
                          const std::filesystem::path& own,
                          const std::filesystem::path& folder);

}  // namespace mjdiag
