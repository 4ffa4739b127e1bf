#include "app/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "app/format.h"

namespace mjdiag::app {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;
constexpr auto kQuiet = milliseconds(2000);
constexpr auto kBetweenDraws = milliseconds(100);
constexpr auto kBetweenLines = milliseconds(5000);
constexpr int kWidth = 32;
constexpr std::size_t kLongestLabel = 40;

}  // namespace

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_(start_) {}

ProgressBar::~ProgressBar() { Wipe(); }

void ProgressBar::Wipe() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void ProgressBar::Show(double fraction) {
  const auto now = Clock::now();
  if (!terminal_ || now - start_ < kQuiet || now - last_ < kBetweenDraws) return;
  last_ = now;
  drawn_ = true;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int full = static_cast<int>(part * kWidth);
  const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                          std::string(static_cast<std::size_t>(kWidth - full), '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%", label_.c_str(), bar.c_str(),
               100.0 * part);
}

void ProgressBar::Show(const std::string& label, double fraction) {
  label_ = label.substr(0, kLongestLabel);
  Show(fraction);
}

std::function<void(double)> ProgressBar::Shower() {
  return [this](double fraction) { Show(fraction); };
}

void ProgressBar::ShowAndSay(double fraction, const std::string& so_far) {
  Show(fraction);
  Say(label_ + ", " + Short(std::round(100.0 * fraction)) + " %", so_far);
}

void ProgressBar::Say(const std::string& what, const std::string& so_far) {
  const auto now = Clock::now();
  if (terminal_ || now - last_ < kBetweenLines) return;
  last_ = now;
  const auto elapsed = std::chrono::duration_cast<std::chrono::seconds>(now - start_);
  std::fprintf(stderr, "%lld s: %s; so far: %s\n",
               static_cast<long long>(elapsed.count()), what.c_str(),
               so_far.empty() ? "nothing" : so_far.c_str());
}

}  // namespace mjdiag::app
