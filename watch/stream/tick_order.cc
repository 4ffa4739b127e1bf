#include "mjdiag/watch/stream/tick_order.h"

#include <algorithm>

namespace mjdiag {
namespace {

/// Gaps whose ticks are told from repeated ones when they come late.
constexpr std::size_t kRememberedGaps = 64;

}  // namespace

TickOrder::TickOrder(const OrderOptions& options, OrderedSink& sink)
    : options_(options), sink_(sink) {}

void TickOrder::Add(const TickHead& head, std::span<const double> values) {
  if (!stream_) {
    Begin(head);
  } else if (head.stream != *stream_) {
    if (head.arrived - last_arrival_ < options_.silence) {
      ++counts_.foreign;
      return;
    }
    while (!waiting_.empty()) GiveUp();
    Begin(head);
  }
  last_arrival_ = head.arrived;
  if (head.number < next_) return AddOld(head, values);
  old_in_a_row_ = 0;
  const bool early = head.number < newest_;
  newest_ = std::max(newest_, head.number);
  if (head.number == next_) {
    counts_.reordered += early ? 1 : 0;
    Emit(head, values);
    return Release();
  }
  const auto [place, is_new] = waiting_.try_emplace(head.number);
  if (!is_new) {
    ++counts_.repeated;
    return;
  }
  counts_.reordered += early ? 1 : 0;
  if (!spare_.empty()) {
    place->second.values = std::move(spare_.back());
    spare_.pop_back();
  }
  place->second.head = head;
  place->second.values.assign(values.begin(), values.end());
  while (waiting_.size() > static_cast<std::size_t>(options_.window)) GiveUp();
}

void TickOrder::Pass(double now) {
  // In the order of their numbers, which is nearly that of their arrival.
  while (!waiting_.empty() &&
         now - waiting_.begin()->second.head.arrived > options_.patience) {
    GiveUp();
  }
}

void TickOrder::Begin(const TickHead& head) {
  stream_ = head.stream;
  next_ = newest_ = head.number;
  old_in_a_row_ = 0;
  given_up_.clear();
  ++counts_.runs;
  sink_.OnNewRun();
}

void TickOrder::Emit(const TickHead& head, std::span<const double> values) {
  next_ = head.number + 1;
  ++counts_.taken;
  sink_.OnTick(head, values);
}

void TickOrder::Release() {
  while (!waiting_.empty() && waiting_.begin()->first == next_) {
    auto node = waiting_.extract(waiting_.begin());
    Emit(node.mapped().head, node.mapped().values);
    spare_.push_back(std::move(node.mapped().values));
  }
}

void TickOrder::GiveUp() {
  const std::int64_t first = waiting_.begin()->first;
  const std::int64_t missing = first - next_;
  counts_.missing += missing;
  ++counts_.gaps;
  given_up_.emplace_back(next_, first);
  if (given_up_.size() > kRememberedGaps) given_up_.pop_front();
  next_ = first;
  sink_.OnMissing(missing);
  Release();
}

void TickOrder::AddOld(const TickHead& head, std::span<const double> values) {
  const bool follows = old_in_a_row_ > 0 && head.number > last_old_;
  old_in_a_row_ = follows ? old_in_a_row_ + 1 : 1;
  last_old_ = head.number;
  if (old_in_a_row_ > options_.old_ticks) {
    while (!waiting_.empty()) GiveUp();
    Begin(head);
    Emit(head, values);
    return;
  }
  const bool late = std::ranges::any_of(given_up_, [&](const auto& gap) {
    return head.number >= gap.first && head.number < gap.second;
  });
  ++(late ? counts_.late : counts_.repeated);
}

}  // namespace mjdiag
