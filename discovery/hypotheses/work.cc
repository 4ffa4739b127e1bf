#include "mjdiag/discovery/hypotheses/work.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {
namespace {

// Of the budget, for intervals and figures of what a search has found.
constexpr double kForTheRest = 0.15;

}  // namespace

double StepWork(int nv) {
  constexpr double kCores = 2.0;
  const double n = nv;
  return 1e-6 * (0.6 + 0.1 * n + 0.005 * n * n) / kCores;
}

void Work::Add(double seconds) { nanoseconds_ += std::llround(1e9 * seconds); }

double Work::used() const { return 1e-9 * static_cast<double>(nanoseconds_.load()); }

double Work::Left() const {
  const double all = searching_ ? (1.0 - kForTheRest) * limit_ : limit_;
  return std::max(all - used(), 0.0);
}

bool Work::MayBegin(const std::string& what, double seconds) {
  if (!cut_ && Left() > seconds && !IsStopped()) return true;
  if (std::ranges::find(left_out_, what) == left_out_.end()) left_out_.push_back(what);
  return false;
}

double Work::Share(int count) const { return Left() / std::max(count, 1); }

void Work::EndSearch() {
  if (cut_ && left_out_.empty()) left_out_.emplace_back("the end of a fit");
  searching_ = false;
  cut_ = false;
}

}  // namespace mjdiag
