#pragma once
// What stands between a program in C and the library: nothing is thrown into it, and
// nothing that it hands over is believed.

#include <exception>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {

/// What the last failing call of this thread has to say.
inline std::string& LastError() {
  thread_local std::string message;
  return message;
}

/// Sets it. Does not allocate where as much has been said before.
inline void Say(const char* message) noexcept {
  try {
    LastError() = message;
  } catch (...) {  // no memory: the status has to do
  }
}

/// While it lives this thread works for mjdiag (host_callback.h).
class Inside {
 public:
  Inside() noexcept { ++depth_; }
  ~Inside() { --depth_; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

  static bool now() noexcept { return depth_ > 0; }

 private:
  inline static thread_local int depth_ = 0;
};

/// Whether the work was done; if not, LastError says why.
template <typename Work>
bool Guard(const Work& work) noexcept {
  try {
    const Inside inside;
    work();
    LastError().clear();
    return true;
  } catch (const std::exception& error) {
    Say(error.what());
  } catch (...) {
    Say("unknown error");
  }
  return false;
}

/// The same as a status: 0 or 1.
template <typename Work>
int Try(const Work& work) noexcept {
  return Guard(work) ? 0 : 1;
}

/// InputError if it is null.
template <typename Type>
Type* NotNull(Type* pointer, const char* what) {
  if (pointer != nullptr) return pointer;
  throw InputError("mjdiag", "a null pointer", what);
}

inline const char* Text(const char* text) { return NotNull(text, "a text"); }

}  // namespace mjdiag
