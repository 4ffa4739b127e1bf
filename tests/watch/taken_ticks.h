#pragma once
// Keeps what it is given.

#include <span>
#include <string>
#include <vector>

#include "mjdiag/watch/stream/tick.h"
#include "mjdiag/watch/stream/tick_layout.h"
#include "mjdiag/watch/stream/tick_order.h"

namespace mjdiag::test {

class TakenTicks final : public TickSink {
 public:
  void Add(const TickHead& head, std::span<const double> values) override {
    heads.push_back(head);
    rows.emplace_back(values.begin(), values.end());
  }

  std::vector<TickHead> heads;
  std::vector<std::vector<double>> rows;
};

/// What comes in order as a text: ticks by their numbers, "-3" where three are missing,
/// "|" where a run begins.
class OrderedText final : public OrderedSink {
 public:
  void OnNewRun() override { text += "| "; }
  void OnMissing(std::int64_t ticks) override {
    text += "-" + std::to_string(ticks) + " ";
  }
  void OnTick(const TickHead& head, std::span<const double>) override {
    text += std::to_string(head.number) + " ";
  }

  std::string text;
};

/// Two readings and a command at 1 kHz.
inline TickLayout SmallLayout() {
  TickLayout layout;
  layout.channels = {{"x", "m", "x"}, {"phi", "rad", "phi"}, {"u", "N", "u"}};
  layout.outputs = 2;
  layout.sample_time = 1e-3;
  return layout;
}

}  // namespace mjdiag::test
