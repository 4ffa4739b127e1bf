#include "mjdiag/plugin/runtime/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace mjdiag {
namespace {

/// That TBB orders the tasks of a loop after what came before it, and what comes after
/// it after its tasks, happens inside a library in which the thread sanitizer sees
/// nothing: it is told. Without a sanitizer these two do nothing.
void AnnounceTo([[maybe_unused]] const void* loop) {
#ifdef __SANITIZE_THREAD__
  __tsan_release(const_cast<void*>(loop));
#endif
}
void LearnFrom([[maybe_unused]] const void* loop) {
#ifdef __SANITIZE_THREAD__
  __tsan_acquire(const_cast<void*>(loop));
#endif
}

class Loop {
 public:
  Loop(int count, const std::function<void(int)>& task,
       const std::function<void(double)>& progress)
      : count_(count), task_(task), progress_(progress) {
    AnnounceTo(this);
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;
  ~Loop() { LearnFrom(this); }

  void DoTask(int number) {
    const Order order(*this);
    task_(number);
    const int done = ++done_;
    if (progress_ && std::this_thread::get_id() == caller_) {
      progress_(static_cast<double>(done) / count_);
    }
  }

 private:
  /// Of a task, which may throw.
  class Order {
   public:
    explicit Order(const Loop& loop) : loop_(loop) { LearnFrom(&loop); }
    Order(const Order&) = delete;
    Order& operator=(const Order&) = delete;
    ~Order() { AnnounceTo(&loop_); }

   private:
    const Loop& loop_;
  };

  int count_;
  const std::function<void(int)>& task_;
  const std::function<void(double)>& progress_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<int> done_ = 0;
};

/// What TBB copies from thread to thread, which the sanitizer is not to look at.
struct LoopBody {
  Loop* loop;
  [[gnu::no_sanitize_thread]] void operator()(
      const tbb::blocked_range<int>& range) const {
    for (int i = range.begin(); i < range.end(); ++i) loop->DoTask(i);
  }
};

}  // namespace

void ParallelFor(int count, const std::function<void(int)>& task,
                 const std::function<void(double fraction)>& progress) {
  Loop loop(count, task, progress);
  // An exception in the loop around this one would else leave tasks of this one undone
  // without a word.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  // A thread that waits here and took up a task of the loop around this one would come
  // back late, and deep in its stack.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count), LoopBody{&loop},
                      tbb::simple_partitioner(), context);
  });
}

void ParallelForAll(int count, const std::function<void(int)>& task) {
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(count));
  ParallelFor(count, [&](int number) {
    try {
      task(number);
    } catch (...) {
      failures[static_cast<std::size_t>(number)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace mjdiag
