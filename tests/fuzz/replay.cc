// Hands every file of a corpus to its target, without libFuzzer:
//   fuzz_replay CORPUS [target...]
// Exit status 1 if one of them is a finding; a crash names its file.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "fuzz/target.h"
#include "mjdiag/signals/text_file.h"

namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 10.0;  // s

std::string current;

void NameTheFile(int signal) {
  const std::string_view words[] = {"a crash: ", current, "\n"};
  for (const std::string_view word : words) {
    if (write(STDERR_FILENO, word.data(), word.size()) < 0) break;
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// What is wrong with an input, or nothing.
std::string Trouble(const mjdiag::fuzz::Target& target, const fs::path& file) {
  const std::string content = mjdiag::ReadTextFile(file);
  const auto begin = std::chrono::steady_clock::now();
  try {
    target.run({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
  } catch (const std::exception& error) {
    return error.what();
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  return took.count() > kPatience ? "hangs" : "";
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty()) {
    std::fprintf(stderr, "fuzz_replay: no corpus; expected CORPUS [target...]\n");
    return 2;
  }
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) {
    std::signal(signal, NameTheFile);
  }
  int findings = 0;
  for (const mjdiag::fuzz::Target& target : mjdiag::fuzz::kTargets) {
    if (arguments.size() > 1 && !std::ranges::count(arguments, target.name)) continue;
    std::vector<fs::path> files;
    for (const auto& entry :
         fs::directory_iterator(fs::path(arguments.front()) / target.name)) {
      files.push_back(entry.path());
    }
    std::ranges::sort(files);
    for (const fs::path& file : files) {
      current = file.string();
      const std::string trouble = Trouble(target, file);
      if (trouble.empty()) continue;
      std::fprintf(stderr, "%s: %s\n", file.c_str(), trouble.c_str());
      ++findings;
    }
    std::printf("%-12s %3zu inputs\n", target.name, files.size());
  }
  return findings == 0 ? 0 : 1;
}
