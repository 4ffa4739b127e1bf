#include "mjdiag/watch/stream/mqtt_client.h"

#include "mjdiag/signals/error.h"

#ifdef MJDIAG_HAS_MQTT
#include <mosquitto.h>

#include <atomic>
#include <deque>
#include <mutex>
#include <utility>
#endif

namespace mjdiag {

#ifndef MJDIAG_HAS_MQTT

bool HasMqtt() { return false; }

std::unique_ptr<MqttClient> OpenMqtt(const StreamAddress& address, const MqttLogin&,
                                     std::function<void(std::string_view)>) {
  throw InputError(AddressText(address), "this mjdiag was built without MQTT",
                   "one that was built where libmosquitto-dev is installed");
}

#else

namespace {

/// Messages that wait for a broker.
constexpr std::size_t kMostWaiting = 1000;
constexpr int kKeepAlive = 10;    // s
constexpr int kLongestPause = 5;  // s between attempts
constexpr int kAtLeastOnce = 1;   // quality of service

struct Library {
  Library() { mosquitto_lib_init(); }
  ~Library() { mosquitto_lib_cleanup(); }
};

struct Outgoing {
  std::string topic;
  std::string message;
  bool retained;
};

class MosquittoClient final : public MqttClient {
 public:
  MosquittoClient(const StreamAddress& address, const MqttLogin& login,
                  std::function<void(std::string_view)> on_message)
      : name_("The broker " + address.host + ":" + std::to_string(address.port)),
        topic_(address.topic),
        on_message_(std::move(on_message)) {
    static const Library library;
    client_ = mosquitto_new(nullptr, true, this);
    if (client_ == nullptr) throw NumericalError("MQTT: no memory for a client");
    try {
      Configure(address, login);
    } catch (...) {
      mosquitto_destroy(client_);
      throw;
    }
    // Whether there is a broker now or later is all the same.
    mosquitto_connect_async(client_, address.host.c_str(), address.port, kKeepAlive);
    mosquitto_loop_start(client_);
  }

  ~MosquittoClient() override {
    mosquitto_disconnect(client_);
    mosquitto_loop_stop(client_, true);
    mosquitto_destroy(client_);
  }

  void Publish(const std::string& topic, const std::string& message,
               bool retained) override {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({topic, message, retained});
    if (waiting_.size() > kMostWaiting) waiting_.pop_front();
    SendWaiting();
  }

  bool connected() const override { return connected_; }
  int connections() const override { return connections_; }
  std::string Trouble() const override {
    if (connected_) return "";
    const std::lock_guard lock(mutex_);
    return name_ + (refusal_.empty() ? " does not answer." : " refuses: " + refusal_);
  }

 private:
  void Configure(const StreamAddress& address, const MqttLogin& login) {
    if (!login.user.empty()) {
      mosquitto_username_pw_set(client_, login.user.c_str(), login.password.c_str());
    }
    if (!login.certificate.empty() &&
        mosquitto_tls_set(client_, login.certificate.c_str(), nullptr, nullptr, nullptr,
                          nullptr) != MOSQ_ERR_SUCCESS) {
      throw InputError(login.certificate, "cannot be used for TLS",
                       "a file of certificates in PEM");
    }
    if (!topic_.empty() && mosquitto_sub_topic_check(topic_.c_str()) != 0) {
      throw InputError(AddressText(address), "no topic of MQTT",
                       "for example plant/ticks");
    }
    mosquitto_reconnect_delay_set(client_, 1, kLongestPause, true);
    mosquitto_connect_callback_set(client_, [](mosquitto*, void* self, int refusal) {
      static_cast<MosquittoClient*>(self)->OnConnect(refusal);
    });
    mosquitto_disconnect_callback_set(client_, [](mosquitto*, void* self, int) {
      static_cast<MosquittoClient*>(self)->connected_ = false;
    });
    mosquitto_message_callback_set(
        client_, [](mosquitto*, void* self, const mosquitto_message* message) {
          static_cast<MosquittoClient*>(self)->on_message_(
              {static_cast<const char*>(message->payload),
               static_cast<std::size_t>(message->payloadlen)});
        });
  }

  void OnConnect(int refusal) {
    const std::lock_guard lock(mutex_);
    refusal_ = refusal == 0 ? "" : mosquitto_connack_string(refusal);
    if (refusal != 0) return;
    connected_ = true;
    ++connections_;
    if (on_message_) mosquitto_subscribe(client_, nullptr, topic_.c_str(), 0);
    SendWaiting();
  }

  /// With the mutex held.
  void SendWaiting() {
    while (connected_ && !waiting_.empty()) {
      const Outgoing& next = waiting_.front();
      const int failure = mosquitto_publish(
          client_, nullptr, next.topic.c_str(), static_cast<int>(next.message.size()),
          next.message.data(), kAtLeastOnce, next.retained);
      if (failure == MOSQ_ERR_NO_CONN || failure == MOSQ_ERR_CONN_LOST) return;
      waiting_.pop_front();
    }
  }

  std::string name_;
  std::string topic_;
  std::function<void(std::string_view)> on_message_;
  mosquitto* client_ = nullptr;
  std::atomic<bool> connected_ = false;
  std::atomic<int> connections_ = 0;
  mutable std::mutex mutex_;
  std::string refusal_;
  std::deque<Outgoing> waiting_;
};

}  // namespace

bool HasMqtt() { return true; }

std::unique_ptr<MqttClient> OpenMqtt(const StreamAddress& address,
                                     const MqttLogin& login,
                                     std::function<void(std::string_view)> on_message) {
  return std::make_unique<MosquittoClient>(address, login, std::move(on_message));
}

#endif

}  // namespace mjdiag
