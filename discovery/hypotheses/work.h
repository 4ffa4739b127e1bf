#pragma once
// What a discovery may cost. It is counted in work and not in time, so that the same
// budget gives the same answer on any machine and with any number of threads: a second
// of work is what two cores of an ordinary desktop do in one second,
//
//   work = sum over runs of samples substeps (a + b nv + c nv^2) / 2,
//
// nv degrees of freedom, and what screenings filter. A search whose answer has not become
// better for as much work again as it took to come to it is taken for settled, and ends
// before.
//
// Work may be added from any thread. What is left is asked for only between moves and
// stages, where no other thread adds any: there the sum is the same every time.

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace mjdiag {

/// One physics step of a plant with nv degrees of freedom, beside the observer [s].
double StepWork(int nv);
/// To filter or correlate so many numbers [s].
double FilterWork(double numbers);

class Work {
 public:
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  /// @param limit  [s]
  /// @param stop   whether the discovery was asked to end; called from any thread, may
  ///               be empty
  explicit Work(double limit = kUnlimited, std::function<bool()> stop = nullptr)
      : limit_(limit), stop_(std::move(stop)) {}

  void Add(double seconds);
  double used() const;
  double limit() const { return limit_; }
  bool IsStopped() const { return stop_ && stop_(); }

  /// A fit ran out of its share: no further move is begun. From any thread.
  void CutShort() { cut_ = true; }

  // Where no other thread adds.

  /// Whether something may be begun that takes at least so much; what may not is kept
  /// (left_out).
  bool MayBegin(const std::string& what, double seconds = 0.0);
  /// What each of `count` parts of a move may use, so that together they do not use
  /// more than is left.
  double Share(int count) const;
  /// The search among laws has a better answer than before.
  void NoteChange() { changed_ = used(); }
  /// Whether that search has gone on for much longer than it took to come to its answer:
  /// nothing of it is begun any more.
  bool IsSettled() const;
  /// The search among laws is over, or all of it: from now on what was kept for forces
  /// without a name, or for the answer, may be used as well.
  void EndLaws();
  void EndSearch();
  const std::vector<std::string>& left_out() const { return left_out_; }

 private:
  double Left() const;
  void EndWith(double part);

  double limit_;
  std::function<bool()> stop_;
  // Whole numbers, whose sum does not depend on their order.
  std::atomic<std::int64_t> nanoseconds_ = 0;
  std::atomic<bool> cut_ = false;
  double part_ = 0.7;  // of the limit, that may be used by now
  double changed_ = 0.0;
  bool among_laws_ = true;
  std::vector<std::string> left_out_;
};

}  // namespace mjdiag
