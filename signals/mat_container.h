#pragma once
// Is a MAT file all there? The readers behind matio trust what they are given, and a
// file that was cut off makes them print, or skip variables without a word. So the
// container is checked first, by its own account of its length.
//
// Version 5: a header of 128 bytes, then elements of a tag (type, number of bytes) and
// that many bytes, up to the end of the file. A file cut exactly between two elements
// cannot be told from a shorter one. Variables that are not compressed have to have the
// bytes for the size that they say.
// Version 7.3: HDF5, whose superblock holds the address of the end of the file.

#include <filesystem>
#include <optional>

namespace mjdiag {

enum class MatVersion { k5, k73 };

/// The version by the file's first bytes, also of a file that was cut off; nothing if
/// it is no MAT file of these versions.
std::optional<MatVersion> DetectMatVersion(const std::filesystem::path& file);

/// InputError if the file is shorter than it, or a variable in it, says.
void RequireCompleteMat(const std::filesystem::path& file, MatVersion version);

}  // namespace mjdiag
