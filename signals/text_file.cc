#include "mjdiag/signals/text_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

std::string Reason() { return std::strerror(errno); }

}  // namespace

std::string ReadTextFile(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    throw InputError(file.string(), "is a folder", "a file");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw InputError(file.string(), "cannot be opened (" + Reason() + ")",
                     "a readable file");
  }
  std::string text;
  const auto size = fs::file_size(file, ignored);
  if (size != static_cast<std::uintmax_t>(-1)) text.reserve(size);
  char block[1 << 16];
  while (stream.read(block, sizeof block) || stream.gcount() > 0) {
    text.append(block, static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) {
    throw InputError(file.string(), "cannot be read", "a readable file");
  }
  return text;
}

void WriteTextFile(const fs::path& file, std::string_view text) {
  FileReplacement replacement(file);
  std::ofstream stream(replacement.temporary(), std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) {
    throw InputError(file.string(), "cannot be written (" + Reason() + ")",
                     "space for " + std::to_string(text.size()) + " bytes");
  }
  replacement.Commit();
}

void MakeOutputFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string(),
                     "is not a folder and cannot be made one" +
                         (error ? " (" + error.message() + ")" : std::string()),
                     "a writable folder");
  }
  const FileReplacement probe(folder / "probe");
  RemoveAbandonedFiles(folder);
}

}  // namespace mjdiag
