#include "mjdiag/watch/stream/tick_decoder.h"

#include <algorithm>
#include <limits>

#include "mjdiag/watch/stream/packet.h"

namespace mjdiag {
namespace {

/// A line longer than this is none.
constexpr std::size_t kLongestLine = 1U << 16;

}  // namespace

TickDecoder::TickDecoder(const TickLayout& layout, TickSink& sink, StreamCounts& counts)
    : layout_(layout), sink_(sink), counts_(counts), lines_(layout, sink, counts) {}

std::size_t TickDecoder::TakePacket(std::string_view bytes, bool whole,
                                    double arrived) {
  if (bytes.size() < kPacketHead) {
    if (whole) counts_.AddNonsense("packet: it ends in its head; expected all of it");
    return 0;
  }
  const auto [head, trouble] = ReadPacketHead(bytes);
  if (trouble != nullptr || head.channels != layout_.channels.size()) {
    const std::string what =
        trouble != nullptr ? trouble : std::to_string(head.channels) + " channels";
    counts_.AddNonsense("packet: " + what + "; expected " +
                        std::to_string(layout_.channels.size()) + " channels of " +
                        LayoutText(layout_));
    // In a stream the next one begins somewhere behind.
    return whole ? 0 : kPacketMagic.size();
  }
  if (bytes.size() < head.bytes()) {
    if (whole) {
      counts_.AddNonsense("packet: " + std::to_string(bytes.size()) +
                          " bytes; expected " + std::to_string(head.bytes()) + " for " +
                          std::to_string(head.ticks) + " ticks");
    }
    return 0;
  }
  counts_.packets.fetch_add(1, std::memory_order_relaxed);
  counts_.ticks.fetch_add(head.ticks, std::memory_order_relaxed);
  values_.resize(std::size_t{head.ticks} * head.channels);
  ReadPacketValues(bytes.substr(kPacketHead), values_);
  for (int k = 0; k < head.ticks; ++k) {
    TickHead tick{head.stream, head.number + k,
                  std::numeric_limits<double>::quiet_NaN(), arrived};
    if (head.sent != 0) {
      tick.sent = 1e-9 * static_cast<double>(head.sent) + k * layout_.sample_time;
    }
    sink_.Add(tick, std::span(values_).subspan(
                        std::size_t{head.channels} * static_cast<std::size_t>(k),
                        head.channels));
  }
  return head.bytes();
}

void TickDecoder::TakeMessage(std::string_view bytes, std::uint32_t sender,
                              double arrived) {
  counts_.bytes.fetch_add(static_cast<std::int64_t>(bytes.size()),
                          std::memory_order_relaxed);
  if (bytes.empty()) return counts_.AddNonsense("packet: empty; expected ticks");
  while (bytes.starts_with(kPacketMagic)) {
    const std::size_t taken = TakePacket(bytes, true, arrived);
    if (taken == 0) return;
    bytes.remove_prefix(taken);
  }
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    lines_.Take(bytes.substr(0, end), sender, arrived);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
}

void TickDecoder::TakePart(std::string_view bytes, double arrived) {
  counts_.bytes.fetch_add(static_cast<std::int64_t>(bytes.size()),
                          std::memory_order_relaxed);
  pending_ += bytes;
  std::string_view rest = pending_;
  while (!rest.empty()) {
    const std::string_view magic = kPacketMagic.substr(0, rest.size());
    if (rest.starts_with(magic)) {
      if (magic.size() < kPacketMagic.size()) break;
      const std::size_t taken = TakePacket(rest, false, arrived);
      if (taken == 0) break;
      rest.remove_prefix(taken);
      continue;
    }
    const std::size_t end = rest.find('\n');
    if (end == rest.npos) {
      if (rest.size() < kLongestLine) break;
      counts_.AddNonsense("line: no end in " + std::to_string(rest.size()) +
                          " bytes; expected a line a tick");
      // A packet may begin in it.
      rest.remove_prefix(std::min(rest.find(kPacketMagic, 1), rest.size()));
      continue;
    }
    lines_.Take(rest.substr(0, end), 0, arrived);
    rest.remove_prefix(end + 1);
  }
  pending_.erase(0, pending_.size() - rest.size());
}

void TickDecoder::EndStream(double arrived) {
  if (pending_.starts_with(kPacketMagic)) {
    TakePacket(pending_, true, arrived);
  } else {
    lines_.Take(pending_, 0, arrived);
  }
  pending_.clear();
}

}  // namespace mjdiag
