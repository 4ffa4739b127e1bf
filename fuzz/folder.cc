#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX

#include <fstream>

#include "fuzz/target.h"

namespace mjdiag::fuzz {
namespace {

namespace fs = std::filesystem;

class ProcessFolder {
 public:
  ProcessFolder() {
    const fs::path memory = "/dev/shm";
    std::error_code ignored;
    std::string name =
        ((fs::is_directory(memory, ignored) ? memory : fs::temp_directory_path()) /
         "mjdiag-fuzz-XXXXXX")
            .string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder " + name);
    path_ = name;
    fs::copy(MJDIAG_SOURCE_DIR "/fuzz/stage", path_);
  }
  ~ProcessFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ProcessFolder(const ProcessFolder&) = delete;
  ProcessFolder& operator=(const ProcessFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

const fs::path& Folder() {
  static const ProcessFolder folder;
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
