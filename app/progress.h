#pragma once
// A progress bar on a terminal for what takes longer than two seconds, and lines
// elsewhere for what takes longer than five.

#include <chrono>
#include <functional>
#include <string>

namespace mjdiag::app {

/// On stderr. The bar is drawn only if that is a terminal, and wipes itself at the end;
/// lines are said only if it is none.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void Show(double fraction);
  /// Says what is being done now, cut to 40 characters.
  void Show(const std::string& label, double fraction);
  /// Show for who is told how far it is; not to outlive the bar.
  std::function<void(double fraction)> Shower();
  /// Every few seconds how far it is: "12 s: screening; so far: coulomb_friction@load".
  /// What is done within the first few says nothing.
  void Say(const std::string& what, const std::string& so_far);
  /// The same and the bar: "12 s: motions, 40 %; so far: ...".
  void ShowAndSay(double fraction, const std::string& so_far);
  /// Clears the line for what is to be printed.
  void Wipe();
  bool is_on_terminal() const { return terminal_; }

 private:
  std::string label_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;  // drawn or said
};

}  // namespace mjdiag::app
