#pragma once
// Calls that take long: the work runs in a thread of its own without the interpreter's
// lock, while the thread that called waits, tells how far it is and listens for Ctrl-C.
// The work never calls Python, so that other Python threads run meanwhile and a slow
// callback holds nothing up.

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace mjdiag::python {

/// Thrown by work that was asked to end and has no answer.
struct Stopped : std::exception {};

/// What work and caller know of each other.
class LongCall {
 public:
  /// For options that take a function: how far the work is. Throws Stopped if it is
  /// asked to end.
  std::function<void(double)> Teller(std::string what);
  /// The same of work that ends by itself if it is asked to.
  void Tell(double fraction, const std::string& what);
  bool IsStopped() const { return stopped_; }
  /// For options that take a function: whether to end, by then or because that many
  /// seconds of work, if there are any, are over. The call must outlive it.
  std::function<bool()> StopAfter(std::optional<double> seconds) const;

 private:
  friend void RunLong(const pybind11::object& progress, bool has_answer,
                      const std::function<void(LongCall&)>& work);
  struct News {
    double fraction;
    std::string what;
  };

  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::optional<News> news_;
  std::exception_ptr failure_;
};

/// @param progress    None or False: nothing is told. A callable: called with the fraction
///                    done and what is being done, in this thread, some fifty times a
///                    second at the most. True: a bar of tqdm, where that is installed
/// @param has_answer  the work has an answer when it is asked to end: so Ctrl-C ends it
///                    like a budget would, and a second one is raised when it has ended.
///                    Else Ctrl-C is raised
/// Rethrows what the work throws, and what the callback raises.
void RunLong(const pybind11::object& progress, bool has_answer,
             const std::function<void(LongCall&)>& work);

}  // namespace mjdiag::python
