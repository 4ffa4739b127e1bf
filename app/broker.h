#pragma once
// Who this command is to an MQTT broker, as `watch` and `simulate --stream` are told.

#include <CLI/CLI.hpp>

#include "mjdiag/watch/stream/mqtt_client.h"

namespace mjdiag::app {

/// --mqtt-user and --mqtt-ca; the password of the user comes from the environment, where
/// nobody else sees it (MJDIAG_MQTT_PASSWORD).
void AddBrokerOptions(CLI::App& command, MqttLogin& login);
/// Call when the options are parsed.
void TakePassword(MqttLogin& login);

}  // namespace mjdiag::app
