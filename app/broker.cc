#include "app/broker.h"

#include <cstdlib>

namespace mjdiag::app {

void AddBrokerOptions(CLI::App& command, MqttLogin& login) {
  command.add_option("--mqtt-user", login.user,
                     "User of the MQTT broker; the password is taken from "
                     "MJDIAG_MQTT_PASSWORD");
  command.add_option("--mqtt-ca", login.certificate,
                     "Certificates that the broker's is checked with: TLS");
}

void TakePassword(MqttLogin& login) {
  const char* password = std::getenv("MJDIAG_MQTT_PASSWORD");
  if (password != nullptr) login.password = password;
}

}  // namespace mjdiag::app
