#include "mjdiag/discovery/hypotheses/work.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {
namespace {

// Of the budget: the rest is for intervals and figures of what a search has found.
constexpr double kOfSearch = 0.85;
constexpr double kCores = 2.0;

}  // namespace

// Measured on one core at 2.5 GHz that did nothing else, in its own time: 0.43 to 0.46 us a
// step with one degree of freedom, 3.0 us with ten, and a little more with effects. The
// quadratic part is that of dense matrices, small up to there.
double StepWork(int nv) {
  const double n = nv;
  return 1e-6 * (0.3 + 0.18 * n + 0.012 * n * n) / kCores;
}

// Measured likewise: a nanosecond for every multiplication that is not in the cache.
double FilterWork(double numbers) { return 1e-9 * numbers / kCores; }

void Work::Add(double seconds) { nanoseconds_ += std::llround(1e9 * seconds); }

double Work::used() const { return 1e-9 * static_cast<double>(nanoseconds_.load()); }

double Work::Left() const { return std::max(part_ * limit_ - used(), 0.0); }

bool Work::IsSettled() const {
  constexpr double kPatience = 1.0;  // times the work that it took
  constexpr double kLeast = 5.0;     // [s]
  return among_laws_ && used() - changed_ > kLeast + kPatience * changed_;
}

bool Work::MayBegin(const std::string& what, double seconds) {
  if (IsSettled()) return false;
  if (!cut_ && Left() > seconds && !IsStopped()) return true;
  if (std::ranges::find(left_out_, what) == left_out_.end()) left_out_.push_back(what);
  return false;
}

double Work::Share(int count) const { return Left() / std::max(count, 1); }

void Work::EndLaws() {
  among_laws_ = false;
  EndWith(kOfSearch);
}

void Work::EndSearch() { EndWith(1.0); }

void Work::EndWith(double part) {
  if (cut_ && left_out_.empty()) left_out_.emplace_back("the end of a fit");
  part_ = part;
  cut_ = false;
}

}  // namespace mjdiag
