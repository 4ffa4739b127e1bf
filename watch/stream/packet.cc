#include "mjdiag/watch/stream/packet.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace mjdiag {
namespace {

static_assert(std::endian::native == std::endian::little,
              "packets are read and written as they lie in memory");

constexpr char kPacketVersion = 1;

template <typename Number>
void Put(Number number, std::size_t at, char* head) {
  std::memcpy(head + at, &number, sizeof number);
}

template <typename Number>
Number Get(std::string_view bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

}  // namespace

int TicksThatFit(std::size_t bytes, std::size_t channels) {
  const std::size_t most = std::numeric_limits<std::uint16_t>::max();
  const std::size_t room = bytes > kPacketHead ? bytes - kPacketHead : 0;
  return static_cast<int>(
      std::clamp(room / (sizeof(double) * channels), std::size_t{1}, most));
}

void AppendPacket(const PacketHead& head, std::span<const double> values,
                  std::string& bytes) {
  const std::size_t at = bytes.size();
  bytes.resize(at + head.bytes());
  char* packet = bytes.data() + at;
  std::memcpy(packet, kPacketMagic.data(), kPacketMagic.size());
  Put(kPacketVersion, 4, packet);
  Put(head.channels, 5, packet);
  Put(head.ticks, 6, packet);
  Put(head.stream, 8, packet);
  Put(std::uint32_t{0}, 12, packet);
  Put(head.number, 16, packet);
  Put(head.sent, 24, packet);
  std::memcpy(packet + kPacketHead, values.data(), values.size_bytes());
}

PacketStart ReadPacketHead(std::string_view bytes) {
  PacketStart start;
  start.head = {Get<std::uint32_t>(bytes, 8), Get<std::int64_t>(bytes, 16),
                Get<std::int64_t>(bytes, 24), Get<std::uint16_t>(bytes, 6),
                Get<std::uint8_t>(bytes, 5)};
  if (!bytes.starts_with(kPacketMagic)) {
    start.trouble = "it does not begin with MJDT";
  } else if (bytes[4] != kPacketVersion) {
    start.trouble = "another version than 1";
  } else if (start.head.ticks == 0 || start.head.channels == 0) {
    start.trouble = "no ticks or no channels in it";
  } else if (Get<std::uint32_t>(bytes, 12) != 0) {
    start.trouble = "not 0 at offset 12";
  } else if (start.head.number < -kMostTicks || start.head.number > kMostTicks) {
    start.trouble = "a number of a tick beyond 10^15";
  }
  return start;
}

void ReadPacketValues(std::string_view bytes, std::span<double> values) {
  std::memcpy(values.data(), bytes.data(), values.size_bytes());
}

}  // namespace mjdiag
