#pragma once
// A progress bar on a terminal for what takes longer than two seconds, and lines
// elsewhere for what takes longer than five.

#include <chrono>
#include <string>

namespace mjdiag::app {

/// Draws on stderr, and only if that is a terminal; wipes itself at the end.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void Show(double fraction);
  /// Clears the line for what is to be printed.
  void Wipe();
  bool is_on_terminal() const { return terminal_; }
  /// Says what is being done now, cut to 40 characters.
  void Show(const std::string& label, double fraction);

 private:
  std::string label_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

/// What runs for long and is not watched on a terminal says every few seconds how far it
/// is, a line each on stderr: "12 s: screening; so far: coulomb_friction@load". What is
/// done within the first few says nothing.
class ProgressLog {
 public:
  ProgressLog();
  void Show(const std::string& what, const std::string& so_far);

 private:
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace mjdiag::app
