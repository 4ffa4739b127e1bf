#pragma once
// The other end: ticks of a simulated machine, or of a record, sent as a real one would
// send them.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "mjdiag/watch/stream/address.h"
#include "mjdiag/watch/stream/mqtt_client.h"
#include "mjdiag/watch/stream/tick_layout.h"

namespace mjdiag {

enum class TickFormat { kPackets, kLines };

struct SendOptions {
  TickFormat format = TickFormat::kPackets;
  /// Ticks a packet or message; 0: 10 ms of them, as many as a datagram has room for.
  int batch = 0;
  /// Every packet repeats the ticks of the one before, so that one that is lost is no loss.
  bool twice = false;
};

class TickSender {
 public:
  virtual ~TickSender() = default;
  /// The next tick, at that time [s since 1970]. Sends when a packet is full.
  virtual void Add(std::span<const double> values, double time) = 0;
  /// What has not been sent yet.
  virtual void Flush() = 0;
  /// Ticks a packet.
  virtual int batch() const = 0;
  /// Packets that the system refused to take.
  virtual std::int64_t refused() const = 0;
};

/// @param layout  outlives it
/// InputError if the address is none to send to, or more ticks are to go into a packet
/// than fit.
std::unique_ptr<TickSender> OpenSender(const StreamAddress& address,
                                       const TickLayout& layout, const MqttLogin& login,
                                       const SendOptions& options);

}  // namespace mjdiag
