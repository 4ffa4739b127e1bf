#include "mjdiag/studies/cluster/run_pool.h"

#include <utility>

#include "mjdiag/plugin/runtime/threads.h"

namespace mjdiag {
namespace {

struct Stopped {};

}  // namespace

RunPool::RunPool(int threads, RankWork work)
    : threads_(threads > 0 ? threads : CoresOfProcess()), work_(std::move(work)) {
  thread_ = std::thread([this] { Begin(); });
}

RunPool::~RunPool() { Stop(); }

void RunPool::Begin() {
  try {
    OnThreads(threads_, [this] {
      work_.prepare([this] {
        if (stopping_) throw Stopped{};
      });
    });
  } catch (const Stopped&) {
    return;
  } catch (...) {
    Fail(-1);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    news_.is_ready = has_news_ = true;
  }
  something_happened_.notify_one();
  // Loops inside a run take no other thread: there is a run for every one.
  std::vector<std::thread> others;
  for (int i = 1; i < threads_; ++i) {
    others.emplace_back([this] { OnThreads(1, [this] { Work(); }); });
  }
  OnThreads(1, [this] { Work(); });
  for (std::thread& other : others) other.join();
}

void RunPool::Work() {
  for (;;) {
    std::int64_t run = -1;
    {
      std::unique_lock lock(mutex_);
      something_to_do_.wait(lock, [&] { return stopping_ || !queue_.empty(); });
      if (stopping_) return;
      run = queue_.front().begin++;
      if (queue_.front().size() == 0) queue_.pop_front();
      --news_.waiting;
    }
    try {
      work_.make(run);
    } catch (...) {
      Fail(run);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      news_.done.push_back(run);
      has_news_ = true;
    }
    something_happened_.notify_one();
  }
}

void RunPool::Fail(std::int64_t run) {
  {
    const std::lock_guard lock(mutex_);
    if (!news_.failure) {
      news_.failure = std::current_exception();
      news_.failed_run = run;
    }
    stopping_ = true;
    has_news_ = true;
  }
  something_to_do_.notify_all();
  something_happened_.notify_one();
}

void RunPool::Add(const std::vector<RunRange>& runs) {
  {
    const std::lock_guard lock(mutex_);
    for (const RunRange& range : runs) {
      queue_.push_back(range);
      news_.waiting += static_cast<std::size_t>(range.size());
    }
  }
  something_to_do_.notify_all();
}

RunPool::News RunPool::Wait(std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  something_happened_.wait_for(lock, longest, [this] { return has_news_; });
  has_news_ = false;
  News news = news_;
  news_.done.clear();
  return news;
}

void RunPool::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  something_to_do_.notify_all();
  if (thread_.joinable()) thread_.join();
}

}  // namespace mjdiag
