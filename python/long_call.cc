#include "python/long_call.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "mjdiag/plugin/runtime/work_time.h"
#include "mjdiag/signals/error.h"
#include "python/arrays.h"

namespace mjdiag::python {
namespace {

namespace py = pybind11;

constexpr auto kBetweenLooks = std::chrono::milliseconds(20);

/// Where news go.
class Display {
 public:
  explicit Display(const py::object& progress) {
    if (progress.is_none() || progress.ptr() == Py_False) return;
    if (progress.ptr() == Py_True) {
      try {
        bar_ = py::module_::import("tqdm.auto")
                   .attr("tqdm")(py::arg("total") = 100, py::arg("unit") = "%",
                                 py::arg("leave") = false);
      } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_ImportError)) throw;
      }
      return;
    }
    if (PyCallable_Check(progress.ptr()) == 0) {
      throw InputError("progress", KindOf(progress),
                       "None, True, or a callable of a fraction and a text");
    }
    callback_ = progress;
  }
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  ~Display() {
    if (!bar_) return;
    PyObject* closed = PyObject_CallMethod(bar_.ptr(), "close", nullptr);
    if (closed == nullptr) PyErr_WriteUnraisable(bar_.ptr());
    Py_XDECREF(closed);
  }

  void Show(double fraction, const std::string& what) {
    const double part = std::clamp(fraction, 0.0, 1.0);
    if (callback_) callback_(part, what);
    if (!bar_) return;
    bar_.attr("set_description")(what, false);
    bar_.attr("n") = 100.0 * part;
    bar_.attr("refresh")();
  }

 private:
  py::object callback_;
  py::object bar_;
};

}  // namespace

std::function<void(double)> LongCall::Teller(std::string what) {
  return [this, what = std::move(what)](double fraction) {
    if (stopped_) throw Stopped{};
    Tell(fraction, what);
  };
}

std::function<bool()> LongCall::StopAfter(std::optional<double> seconds) const {
  return [this, is_over = AfterWork(seconds)] { return IsStopped() || is_over(); };
}

void LongCall::Tell(double fraction, const std::string& what) {
  const std::lock_guard lock(mutex_);
  news_ = {fraction, what};
}

void RunLong(const py::object& progress, bool has_answer,
             const std::function<void(LongCall&)>& work) {
  Display display(progress);
  LongCall call;
  std::thread thread([&] {
    try {
      work(call);
    } catch (...) {
      call.failure_ = std::current_exception();
    }
    const std::lock_guard lock(call.mutex_);
    call.done_ = true;
    call.ended_.notify_all();
  });
  // Raised here while the work was going on; told when it has ended.
  std::exception_ptr raised;
  std::string last;
  for (bool done = false; !done;) {
    std::optional<LongCall::News> news;
    {
      const py::gil_scoped_release others_run;
      std::unique_lock lock(call.mutex_);
      done = call.ended_.wait_for(lock, kBetweenLooks, [&] { return call.done_; });
      news.swap(call.news_);
    }
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (news && !raised) display.Show(news->fraction, last = news->what);
    } catch (const py::error_already_set& error) {
      const bool is_first = !call.stopped_.exchange(true);
      const bool is_wish =
          has_answer && is_first && error.matches(PyExc_KeyboardInterrupt);
      if (!is_wish) raised = std::current_exception();
    } catch (...) {
      call.stopped_ = true;
      raised = std::current_exception();
    }
  }
  thread.join();
  if (raised) std::rethrow_exception(raised);
  if (call.failure_) std::rethrow_exception(call.failure_);
  display.Show(1.0, last);
}

}  // namespace mjdiag::python
