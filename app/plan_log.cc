#include "app/plan_log.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace mjdiag::app {
namespace {

constexpr auto kBetweenNews = std::chrono::seconds(5);
constexpr int kMinute = 60;
constexpr int kHour = 3600;

/// "21 s", "3 min 5 s", "2 h 10 min".
std::string DurationText(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  const auto with = [](long long count, const char* unit) {
    return std::to_string(count) + " " + unit;
  };
  if (whole < kMinute) return with(whole, "s");
  if (whole < kHour) return with(whole / kMinute, "min ") + with(whole % kMinute, "s");
  return with(whole / kHour, "h ") + with(whole % kHour / kMinute, "min");
}

}  // namespace

std::string ProgressText(const PlanProgress& progress) {
  std::string text =
      std::to_string(progress.done) + " of " + std::to_string(progress.total) + " runs";
  if (const double rate = progress.RunsASecond(); rate > 0.0) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.3g", rate);
    text += ", " + std::string(digits.data()) + " a second";
  }
  const auto left = progress.SecondsLeft();
  if (left && progress.done < progress.total) {
    text += ", " + DurationText(*left) + " to go";
  }
  return text;
}

PlanLog::PlanLog(const std::filesystem::path& folder)
    : file_(folder / "study.log"),
      bar_("study"),
      last_(std::chrono::steady_clock::now()) {}

void PlanLog::Show(const PlanProgress& progress) {
  const double fraction =
      static_cast<double>(progress.done) /
      static_cast<double>(std::max<std::int64_t>(progress.total, 1));
  const bool runs = std::string(progress.doing) == "runs";
  bar_.Show(runs ? ProgressText(progress) : progress.doing, fraction);
  const auto now = std::chrono::steady_clock::now();
  const bool begins = doing_ != progress.doing;
  doing_ = progress.doing;
  if (!begins && now - last_ < kBetweenNews) return;
  last_ = now;
  Write(progress);
}

void PlanLog::Append(const std::string& line) {
  if (!log_.is_open()) log_.open(file_, std::ios::app);
  log_ << line << std::flush;
}

void PlanLog::Note(const std::string& line) {
  bar_.Wipe();
  std::fputs(("study: " + line + "\n").c_str(), stderr);
  Append(line + "\n");
}

void PlanLog::Write(const PlanProgress& progress) {
  const std::string line = DurationText(progress.seconds) + ": " + progress.doing +
                           ": " + ProgressText(progress) + "\n";
  Append(line);
  // What takes no longer than a moment says nothing on the terminal.
  const bool is_long =
      progress.seconds > std::chrono::duration<double>(kBetweenNews).count();
  if (is_long && !bar_.is_on_terminal()) std::fputs(line.c_str(), stderr);
}

void PlanLog::End(const PlanProgress& progress) {
  PlanProgress ended = progress;
  ended.doing = "done";
  bar_.Wipe();
  Write(ended);
}

}  // namespace mjdiag::app
