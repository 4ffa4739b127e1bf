#pragma once
// A client of an MQTT broker, of messages that come in, go out, or both. It connects by
// itself, for ever, whenever the broker is there; what goes out while it is not waits, the
// latest messages of each topic up to a bound.

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "mjdiag/watch/stream/address.h"

namespace mjdiag {

/// Who one is to a broker.
struct MqttLogin {
  std::string user;         ///< empty: nobody
  std::string password;     ///< of the user
  std::string certificate;  ///< file of those that are trusted: TLS; empty: none
};

class MqttClient {
 public:
  virtual ~MqttClient() = default;

  /// Sends it, now or once there is a broker. Does not wait.
  /// @param retained  the broker keeps it for those that come later
  virtual void Publish(const std::string& topic, const std::string& message,
                       bool retained) = 0;
  virtual bool connected() const = 0;
  /// Times that it has.
  virtual int connections() const = 0;
  /// Why it is not connected, a sentence; empty: it is.
  virtual std::string Trouble() const = 0;
};

/// Whether this mjdiag was built with MQTT.
bool HasMqtt();

/// @param on_message  called from its thread with every message of the topic of the
///                    address; empty: it does not subscribe
/// InputError without MQTT, or if the certificate cannot be read.
std::unique_ptr<MqttClient> OpenMqtt(
    const StreamAddress& address, const MqttLogin& login,
    std::function<void(std::string_view)> on_message = {});

}  // namespace mjdiag
