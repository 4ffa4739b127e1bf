#pragma once
// Logs in formats that are not read here, each with the line of Python that makes one of
// them that is.

#include <filesystem>
#include <string_view>

namespace mjdiag {

/// InputError if the file is Parquet, Arrow, npz, npy, pickle, a spreadsheet or a bag of
/// ROS, by its first bytes and, where these say too little, by its ending.
/// @param head  the first bytes of the file, 16 at least where it has them
void RefuseForeignFormat(const std::filesystem::path& file, std::string_view head);

}  // namespace mjdiag
