// Ticks from outside: datagrams, streams and lines, put in order and timed.
//
// Input: a byte that says how (message or stream, how large its parts are), then what the
// sender sends; messages are divided by the bytes "\n--\n".

#include <vector>

#include "fuzz/target.h"
#include "mjdiag/watch/stream/stream_clock.h"
#include "mjdiag/watch/stream/tick_decoder.h"
#include "mjdiag/watch/stream/tick_order.h"
#include "mjdiag/watch/stream/tick_queue.h"

namespace mjdiag::fuzz {
namespace {

constexpr double kSampleTime = 1e-3;
constexpr std::string_view kDivider = "\n--\n";

TickLayout Layout() {
  TickLayout layout;
  layout.channels = {{"q", "m", "qm", "mm"}, {"u", "V", "u"}};
  layout.outputs = 1;
  layout.sample_time = kSampleTime;
  return layout;
}

/// What comes behind the order: ticks of a run count up.
class Ordered final : public OrderedSink {
 public:
  void OnNewRun() override {
    clock_.Begin();
    begun_ = false;
  }
  void OnMissing(std::int64_t ticks) override {
    Require(ticks > 0, "missing ticks that are none");
    missing_ = ticks;
  }
  void OnTick(const TickHead& head, std::span<const double> values) override {
    Require(values.size() == 2, "another number of channels");
    if (begun_) {
      Require(head.number == next_ + missing_, "a tick out of its order");
    }
    begun_ = true;
    missing_ = 0;
    next_ = head.number + 1;
    clock_.Add(head);
  }
  const StreamClock& clock() const { return clock_; }

 private:
  StreamClock clock_{kSampleTime, true};
  bool begun_ = false;
  std::int64_t next_ = 0;
  std::int64_t missing_ = 0;
};

class Sink final : public TickSink {
 public:
  void Add(const TickHead& head, std::span<const double> values) override {
    order_.Add(head, values);
    queue_.Add(head, values);
  }
  void Pass(double now) { order_.Pass(now); }
  void End() {
    TickBlock block;
    queue_.Take(0.0, block);
    ordered_.clock().Notes();
  }

 private:
  Ordered ordered_;
  TickOrder order_{{8, 0.1, 1.0, 4}, ordered_};
  StreamCounts counts_;
  TickQueue queue_{2, 16, TickQueue::WhenFull::kLose, counts_};
};

}  // namespace

void FuzzPackets(Input input) {
  static const TickLayout layout = Layout();
  Choices choices(input);
  const std::uint8_t how = choices.Byte();
  std::string_view bytes = TextOf(choices.Rest());
  Sink sink;
  StreamCounts counts;
  TickDecoder decoder(layout, sink, counts);
  double now = 1.6e9;
  if (how % 2 == 0) {
    for (std::uint32_t sender = how / 2U % 4U; !bytes.empty(); now += 0.3) {
      const std::size_t end = bytes.find(kDivider);
      decoder.TakeMessage(bytes.substr(0, end), sender, now);
      bytes.remove_prefix(end == bytes.npos ? bytes.size() : end + kDivider.size());
      sink.Pass(now);
    }
  } else {
    const std::size_t part = 1U + how / 2U;
    for (; !bytes.empty(); now += 1e-2) {
      decoder.TakePart(bytes.substr(0, part), now);
      bytes.remove_prefix(std::min(part, bytes.size()));
      sink.Pass(now);
    }
    decoder.EndStream(now);
  }
  sink.End();
}

}  // namespace mjdiag::fuzz
