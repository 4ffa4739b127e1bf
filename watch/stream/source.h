#pragma once
// Where ticks come from. A source has a thread of its own, which does nothing but take
// bytes, decode them and fill a queue; it ends with the object.

#include <memory>
#include <string>

#include "mjdiag/watch/stream/address.h"
#include "mjdiag/watch/stream/mqtt_client.h"
#include "mjdiag/watch/stream/stream_counts.h"
#include "mjdiag/watch/stream/tick_layout.h"
#include "mjdiag/watch/stream/tick_queue.h"

namespace mjdiag {

class Source {
 public:
  virtual ~Source() = default;

  /// "udp:127.0.0.1:9870"
  virtual std::string Name() const = 0;
  /// Nothing more will come.
  virtual bool ended() const { return false; }
  /// What it suffers from, a sentence; empty: nothing.
  virtual std::string Trouble() const { return ""; }
};

/// Whether ticks of that address come as fast as they happen. Those of a file or pipe
/// come as fast as they are taken, and wait till they are.
bool IsLive(const StreamAddress& address);

/// Opens it and begins. All outlive it. InputError if its port is in use or its host not
/// known, or this mjdiag was built without MQTT.
/// @param login  of the broker
std::unique_ptr<Source> OpenSource(const StreamAddress& address,
                                   const TickLayout& layout, const MqttLogin& login,
                                   TickQueue& queue, StreamCounts& counts);

/// That reads a descriptor to its end, for example 0.
std::unique_ptr<Source> OpenDescriptor(int descriptor, const TickLayout& layout,
                                       TickQueue& queue, StreamCounts& counts);

}  // namespace mjdiag
