#pragma once
// Runs the command as a user would.

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/temporary_folder.h"

namespace mjdiag {

struct CommandResult {
  int status = -1;
  std::string out;
  std::string err;
};

using test::TemporaryFolder;

inline std::string ReadAll(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// `mjdiag <arguments>`, run by a shell in the repository's root.
inline CommandResult RunCommand(const std::string& arguments) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  const std::string err = (folder.path() / "err").string();
  const std::string line = "cd '" MJDIAG_SOURCE_DIR "' && '" MJDIAG_COMMAND "' " +
                           arguments + " >'" + out + "' 2>'" + err + "'";
  const int raw = std::system(line.c_str());
  return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, ReadAll(out), ReadAll(err)};
}

}  // namespace mjdiag
