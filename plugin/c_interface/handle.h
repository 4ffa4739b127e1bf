#pragma once
// What a program in C holds of an object of the library: a handle, which outlives the
// object. A call with the handle of what is closed is refused then; with a pointer to
// what is gone it would be undefined. A handle has a few bytes, and is kept for good.

#include <deque>
#include <memory>
#include <mutex>
#include <utility>

#include "guard.h"

namespace mjdiag {

/// @tparam Handle  a struct whose only member is `std::unique_ptr<...> object`
template <typename Handle>
class Handles {
 public:
  using Object = decltype(Handle::object);

  static Handle* Open(Object object) {
    Handles& all = All();
    const std::lock_guard lock(all.mutex_);
    return &all.handles_.emplace_back(Handle{std::move(object)});
  }

  /// Whether an open object is like that.
  template <typename Condition>
  static bool Any(const Condition& condition) {
    Handles& all = All();
    const std::lock_guard lock(all.mutex_);
    for (const Handle& handle : all.handles_) {
      if (handle.object != nullptr && condition(*handle.object)) return true;
    }
    return false;
  }

  /// Nothing if it is closed already.
  static Object Close(Handle& handle) {
    const std::lock_guard lock(All().mutex_);
    return std::move(handle.object);
  }

 private:
  /// Never destroyed: a program may hold handles to its very end.
  static Handles& All() {
    static auto& all = *new Handles;
    return all;
  }

  std::mutex mutex_;
  std::deque<Handle> handles_;
};

/// The object of a handle. InputError if that is null or closed.
template <typename Handle>
auto& Opened(Handle* handle, const char* what) {
  if (NotNull(handle, what)->object != nullptr) return *handle->object;
  throw InputError("mjdiag", "a handle that is closed", what);
}

}  // namespace mjdiag
