#pragma once
// Fuzzers: what reads bytes from outside is given arbitrary ones. Bad input may be refused
// (InputError) and a computation on it may fail (NumericalError); whatever else escapes, a
// property that does not hold, a crash, a leak or a hang is a finding.
//
// Each target is a function of some bytes. With Clang each becomes a program of libFuzzer
// (fuzzer.cc); the ordinary tests hand all of them the files of corpus/<target> (replay.cc),
// the inputs of earlier findings among them.

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mjdiag/signals/error.h"

namespace mjdiag::fuzz {

using Input = std::span<const std::uint8_t>;

void FuzzCInterface(Input input);
void FuzzCsv(Input input);
void FuzzFilters(Input input);
void FuzzManifest(Input input);
void FuzzMat(Input input);
void FuzzMjcf(Input input);
void FuzzOptions(Input input);
void FuzzPackets(Input input);
void FuzzPlan(Input input);
void FuzzSetup(Input input);

struct Target {
  const char* name;
  void (*run)(Input);
};
inline constexpr std::array<Target, 10> kTargets{{{"c_interface", FuzzCInterface},
                                                  {"csv", FuzzCsv},
                                                  {"filters", FuzzFilters},
                                                  {"manifest", FuzzManifest},
                                                  {"mat", FuzzMat},
                                                  {"mjcf", FuzzMjcf},
                                                  {"options", FuzzOptions},
                                                  {"packets", FuzzPackets},
                                                  {"plan", FuzzPlan},
                                                  {"setup", FuzzSetup}}};

/// What nobody catches: libFuzzer keeps the input.
class Finding : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void Require(bool holds, const std::string& what) {
  if (!holds) throw Finding(what);
}

/// Whether the work was done, and not refused with a line that says what was expected.
template <typename Work>
bool Done(const Work& work) {
  try {
    work();
    return true;
  } catch (const InputError& error) {
    Require(std::string_view(error.what()).find("expected") != std::string_view::npos,
            std::string("says nothing of what was expected: ") + error.what());
  } catch (const NumericalError&) {
  }
  return false;
}

/// For work on what was accepted before: to refuse it is a finding, too.
template <typename Work>
void MustDo(const std::string& what, const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    throw Finding(what + ": " + error.what());
  }
}

inline std::string_view TextOf(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

/// Choices that are made by bytes; 0 behind their end.
class Choices {
 public:
  explicit Choices(Input bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }
  std::uint8_t Byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  /// From 0 to below `count`, which is at most 256.
  std::size_t Below(std::size_t count) { return Byte() % count; }
  /// What is left up to a byte 0, which is taken.
  std::string_view Word() {
    const std::string_view text = TextOf(bytes_);
    const std::string_view word = text.substr(0, text.find('\0'));
    bytes_ = bytes_.subspan(std::min(word.size() + 1, bytes_.size()));
    return word;
  }
  Input Rest() const { return bytes_; }

 private:
  Input bytes_;
};

/// A folder of this process, in memory where the system has that, removed at its end.
/// It holds the machine of stage/.
const std::filesystem::path& Folder();
/// Writes a file of it.
std::filesystem::path WriteFile(const std::string& name, std::string_view content);

}  // namespace mjdiag::fuzz
