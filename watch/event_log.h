#pragma once
// Who is told of what has changed: the caller, a file of JSON lines, and a broker.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "mjdiag/watch/judge/verdict_keeper.h"
#include "mjdiag/watch/live_state.h"
#include "mjdiag/watch/stream/mqtt_client.h"

namespace mjdiag {

struct WatchOptions;

/// What is told: a line of JSON, and what a broker keeps for those that come later.
struct WatchEvent {
  std::string line;
  std::string retained;  ///< empty: nothing
};

/// {"event": "verdict", "time", "iso", "verdict", "before"}
WatchEvent VerdictEvent(double time, const VerdictChange& change);
/// {"event": "source", "time", "iso", "source", "state", "words"}
WatchEvent SourceEvent(double time, const SourceReport& source,
                       const std::string& words);

class EventLog {
 public:
  /// @param options  its folder, broker and callback
  explicit EventLog(const WatchOptions& options);

  void Tell(const WatchEvent& event);

 private:
  std::filesystem::path file_;  // empty: none
  std::function<void(const std::string&)> on_event_;
  std::string topic_;
  std::unique_ptr<MqttClient> broker_;
};

}  // namespace mjdiag
