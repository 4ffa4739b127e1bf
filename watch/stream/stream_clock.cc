#include "mjdiag/watch/stream/stream_clock.h"

#include <cmath>
#include <limits>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

/// Stretches over which rates are taken, by the count [s].
constexpr double kStretch = 30.0;
constexpr double kShortest = 1.0;
constexpr double kShortestArrival = 3.0;
/// Of such a stretch our clock sees when packets came, which is late by up to so much [s].
constexpr double kArrivalDelay = 0.1;
/// A clock that says it was so much longer or shorter than the count was set [s].
constexpr double kStep = 0.1;
/// A rate that is so far off is another one.
constexpr double kOtherRate = 0.01;
/// Crystals differ by less.
constexpr double kWorthSaying = 2e-4;
/// Clocks that show the date show more than this [s]: 2001.
constexpr double kDate = 1e9;
/// Offset from which on one wonders [s].
constexpr double kWonder = 1.0;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::string Percent(double part) {
  return std::abs(part) < 1e-3 ? FormatNumber(1e6 * part) + " ppm"
                               : FormatNumber(100.0 * part) + " %";
}

}  // namespace

StreamClock::StreamClock(double sample_time, bool live)
    : sample_time_(sample_time), live_(live) {
  report_.offset = kUnknown;
  Begin();
}

void StreamClock::Begin() {
  first_.reset();
  last_.reset();
  report_.sent_rate = report_.arrived_rate = kUnknown;
}

void StreamClock::Add(const TickHead& head) {
  if (last_) {
    const double counted =
        sample_time_ * static_cast<double>(head.number - last_->number);
    const double shown = head.sent - last_->sent;
    if (std::abs(shown - counted) > kStep + kOtherRate * counted) {
      // A gap in the count as long as that in time is none of it.
      ++report_.steps;
      first_.reset();
    }
  }
  last_ = head;
  if (head.sent > kDate) report_.offset = head.sent - head.arrived;
  if (!first_) {
    first_ = head;
    return;
  }
  const double counted =
      sample_time_ * static_cast<double>(head.number - first_->number);
  if (counted < kShortest) return;
  report_.sent_rate = (head.sent - first_->sent) / counted - 1.0;
  if (live_ && counted > kShortestArrival)
    report_.arrived_rate = (head.arrived - first_->arrived) / counted - 1.0;
  if (counted > kStretch) first_ = head;
}

bool StreamClock::wrong_rate() const {
  return std::abs(report_.sent_rate) > kOtherRate ||
         std::abs(report_.arrived_rate) > kOtherRate + kArrivalDelay / kShortestArrival;
}

std::vector<std::string> StreamClock::Notes() const {
  std::vector<std::string> notes;
  const double rate =
      std::isnan(report_.sent_rate) ? report_.arrived_rate : report_.sent_rate;
  if (wrong_rate()) {
    notes.push_back("Ticks come every " +
                    FormatQuantity(sample_time_ * (1.0 + rate), "s") +
                    ", the setup says every " + FormatQuantity(sample_time_, "s") +
                    ": what the filters and the twin say of them means nothing.");
  } else if (std::abs(report_.sent_rate) > kWorthSaying) {
    notes.push_back("The clock of the sender and its ticks differ by " +
                    Percent(report_.sent_rate) + "; the ticks are believed.");
  }
  if (std::abs(report_.offset) > kWonder) {
    notes.push_back("The clock of the sender is " +
                    FormatQuantity(std::abs(report_.offset), "s") +
                    (report_.offset > 0.0 ? " ahead of" : " behind") +
                    " this one; times here are of this one.");
  }
  if (report_.steps > 0) {
    notes.push_back("The clock of the sender was set " + std::to_string(report_.steps) +
                    (report_.steps == 1 ? " time." : " times."));
  }
  return notes;
}

}  // namespace mjdiag
