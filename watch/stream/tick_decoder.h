#pragma once
// Bytes from outside, whatever they are, as ticks: packets (packet.h) and lines
// (tick_lines.h), told apart by how they begin. What is neither is counted, never fatal.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mjdiag/watch/stream/stream_counts.h"
#include "mjdiag/watch/stream/tick.h"
#include "mjdiag/watch/stream/tick_layout.h"
#include "mjdiag/watch/stream/tick_lines.h"

namespace mjdiag {

class TickDecoder {
 public:
  /// All outlive it.
  TickDecoder(const TickLayout& layout, TickSink& sink, StreamCounts& counts);

  /// A datagram or message: whole packets, or whole lines.
  /// @param sender  a number for where it comes from, which lines do not say
  void TakeMessage(std::string_view bytes, std::uint32_t sender, double arrived);

  /// The next part of a stream, which may end anywhere.
  void TakePart(std::string_view bytes, double arrived);
  /// No more comes of the stream: a last line without an end is one.
  void EndStream(double arrived);

 private:
  /// A packet at the begin of `bytes`, if all of it is there.
  /// @return its bytes; 0: not yet all there, or none, and counted
  std::size_t TakePacket(std::string_view bytes, bool whole, double arrived);

  const TickLayout& layout_;
  TickSink& sink_;
  StreamCounts& counts_;
  TickLines lines_;
  std::string pending_;  // of the stream
  std::vector<double> values_;
};

}  // namespace mjdiag
