#pragma once
// Ticks as bytes: a packet is a datagram of UDP, a message of MQTT, or stands behind
// another one in a stream. All numbers little-endian.
//
//   offset  bytes  what
//        0      4  "MJDT"
//        4      1  version, 1
//        5      1  channels: readings, then commands, in the order of the setup
//        6      2  ticks in this packet, N
//        8      4  stream: any number that the sender draws when it starts
//       12      4  0
//       16      8  number of the first tick, within +-10^15; the others follow it without a
//                  gap
//       24      8  clock of the sender at the first tick [ns since 1970]; 0: it has none
//       32    8 N channels  float64, tick by tick; NaN: not measured

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mjdiag {

inline constexpr std::string_view kPacketMagic = "MJDT";
inline constexpr std::size_t kPacketHead = 32;  ///< bytes before the numbers
inline constexpr std::size_t kMostChannels = 255;
/// Numbers of ticks are not beyond that: 30000 years at 1 kHz.
inline constexpr std::int64_t kMostTicks = 1'000'000'000'000'000;
/// Of a datagram of UDP.
inline constexpr std::size_t kMostPacketBytes = 65507;

struct PacketHead {
  std::uint32_t stream = 0;
  std::int64_t number = 0;
  std::int64_t sent = 0;  ///< [ns since 1970]; 0: no clock
  std::uint16_t ticks = 0;
  std::uint8_t channels = 0;

  std::size_t bytes() const {
    return kPacketHead + sizeof(double) * std::size_t{ticks} * channels;
  }
};

/// Ticks that fit into a packet of that many bytes; at least one.
int TicksThatFit(std::size_t bytes, std::size_t channels);

/// Appends a packet to `bytes`.
/// @param values  tick by tick, head.ticks x head.channels
void AppendPacket(const PacketHead& head, std::span<const double> values,
                  std::string& bytes);

/// What a packet begins with.
struct PacketStart {
  PacketHead head;
  /// Null, or what is wrong with it: "another version than 1".
  const char* trouble = nullptr;
};
/// @param bytes  kPacketHead or more
PacketStart ReadPacketHead(std::string_view bytes);
/// @param bytes   behind the head
void ReadPacketValues(std::string_view bytes, std::span<double> values);

}  // namespace mjdiag
