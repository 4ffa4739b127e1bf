#include <fstream>

#include "fuzz/target.h"
#include "support/temporary_folder.h"

namespace mjdiag::fuzz {
namespace {

namespace fs = std::filesystem;

/// In memory where the system has that.
fs::path Within() {
  const fs::path memory = "/dev/shm";
  std::error_code ignored;
  return fs::is_directory(memory, ignored) ? memory : fs::temp_directory_path();
}

class FolderWithStage : public test::TemporaryFolder {
 public:
  FolderWithStage() : TemporaryFolder(Within()) {
    fs::copy(MJDIAG_SOURCE_DIR "/tests/fuzz/stage", path());
  }
};

}  // namespace

const fs::path& Folder() {
  static const FolderWithStage folder;
  return folder.path();
}

fs::path WriteFile(const std::string& name, std::string_view content) {
  fs::path file = Folder() / name;
  std::ofstream stream(file, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
  return file;
}

}  // namespace mjdiag::fuzz
