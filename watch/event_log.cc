#include "mjdiag/watch/event_log.h"

#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "mjdiag/watch/live_watch.h"

namespace mjdiag {
namespace {

/// "2026-03-01T12:00:00.123Z"
std::string IsoTime(double time) {
  const auto seconds = static_cast<std::time_t>(std::floor(time));
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::array<char, 8> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%03dZ",
                static_cast<int>(1e3 * (time - std::floor(time))));
  return std::string(text.data()) + fraction.data();
}

}  // namespace

WatchEvent VerdictEvent(double time, const VerdictChange& change) {
  const nlohmann::json verdict = ToJson(change.now);
  const nlohmann::json event = {{"event", "verdict"},
                                {"time", time},
                                {"iso", IsoTime(time)},
                                {"verdict", verdict},
                                {"before", ToJson(change.before)}};
  return {event.dump(), verdict.dump()};
}

WatchEvent SourceEvent(double time, const SourceReport& source,
                       const std::string& words) {
  const nlohmann::json event = {{"event", "source"},
                                {"time", time},
                                {"iso", IsoTime(time)},
                                {"source", source.name},
                                {"state", NameOf(source.state)},
                                {"words", words}};
  return {event.dump(), ""};
}

EventLog::EventLog(const WatchOptions& options) : on_event_(options.on_event) {
  if (!options.folder.empty()) file_ = options.folder / "events.jsonl";
  if (!options.publish) return;
  StreamAddress broker = *options.publish;
  topic_ = broker.topic;
  broker_ = OpenMqtt(broker, options.login);
}

void EventLog::Tell(const WatchEvent& event) {
  if (on_event_) on_event_(event.line);
  if (!file_.empty()) std::ofstream(file_, std::ios::app) << event.line << '\n';
  if (!broker_) return;
  broker_->Publish(topic_ + "/events", event.line, false);
  if (!event.retained.empty()) {
    broker_->Publish(topic_ + "/verdict", event.retained, true);
  }
}

}  // namespace mjdiag
