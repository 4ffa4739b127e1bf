#pragma once
// `simulate --stream`: a simulated machine, or a record, in real time to whoever listens.

#include <CLI/CLI.hpp>
#include <string>

#include "app/subject.h"
#include "mjdiag/watch/stream/tick_sender.h"

namespace mjdiag::app {

struct StreamOptions {
  std::string target;  ///< empty: no stream
  std::string format = "binary";
  std::string play;       ///< record whose samples are sent as they are
  double speed = 1.0;     ///< seconds of the machine a second; 0: as fast as it goes
  double duration = 0.0;  ///< [s] of the machine; 0: till it is interrupted
  SendOptions send;
  MqttLogin login;

  bool wanted() const { return !target.empty(); }
};

void AddStreamOptions(CLI::App& command, StreamOptions& options);

/// Streams till the duration is over, or SIGINT or SIGTERM. The motion begins again when
/// it has ended.
void Stream(const Subject& subject, const MotionOptions& motion,
            const StreamOptions& options);

}  // namespace mjdiag::app
