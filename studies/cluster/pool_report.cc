#include "mjdiag/studies/cluster/pool_report.h"

#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {

void TellFailure(const std::exception_ptr& failure, RankReport& report) {
  report.kind = RankReport::Kind::kFailed;
  try {
    std::rethrow_exception(failure);
  } catch (const InputError& error) {
    report.bad_input = true;
    report.text = error.what();
  } catch (const std::exception& error) {
    report.text = error.what();
  } catch (...) {
    report.text = "failed";
  }
}

std::optional<RankReport> PoolReport::Next(std::chrono::milliseconds longest) {
  constexpr auto kBeat = std::chrono::seconds(1);
  const RunPool::News news = pool_.Wait(longest);
  done_.insert(done_.end(), news.done.begin(), news.done.end());
  has_waiting_ = news.waiting > 0;
  const auto threads = static_cast<std::size_t>(pool_.threads());
  const bool begins = news.is_ready && !is_prepared_;
  const bool fails = news.failure && !has_failed_;
  const bool hungry = !done_.empty() && news.waiting < threads;
  const auto now = std::chrono::steady_clock::now();
  if (!begins && !fails && !hungry && now - last_ < kBeat) return std::nullopt;
  last_ = now;
  is_prepared_ = news.is_ready;
  RankReport report;
  report.study = study_;
  report.threads = is_prepared_ ? static_cast<std::uint32_t>(threads) : 0;
  report.done = std::exchange(done_, {});
  if (fails) {
    has_failed_ = true;
    report.run = news.failed_run;
    TellFailure(news.failure, report);
  }
  return report;
}

std::vector<std::int64_t> PoolReport::Rest() {
  const RunPool::News news = pool_.Wait(std::chrono::milliseconds(0));
  done_.insert(done_.end(), news.done.begin(), news.done.end());
  return std::exchange(done_, {});
}

}  // namespace mjdiag
