#pragma once
// All that is known of a machine that is watched, at a moment: what pages, metrics and
// other programs are told.

#include <cstdint>
#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "mjdiag/watch/judge/verdict_keeper.h"
#include "mjdiag/watch/stream/stream_clock.h"
#include "mjdiag/watch/stream/tick_order.h"

namespace mjdiag {

enum class SourceState {
  kWaiting,   ///< nothing has come yet
  kRunning,   ///< ticks come in
  kSilent,    ///< none since a while
  kOtherRate  ///< they come in at another rate than the setup's
};
const char* NameOf(SourceState state);

struct SourceReport {
  std::string name;
  SourceState state = SourceState::kWaiting;
  double since = 0.0;      ///< of that state [s since 1970]
  double last_tick = 0.0;  ///< when the last one came [s since 1970]; 0: none
  std::int64_t packets = 0, ticks = 0, bytes = 0;
  std::int64_t nonsense = 0;
  std::string last_nonsense;
  std::int64_t no_room = 0;  ///< ticks lost because the diagnosis was behind
  std::int64_t kernel = 0;   ///< datagrams lost in the system
  OrderCounts order;
  std::int64_t runs = 0;  ///< of the diagnosis
  ClockReport clock;
  std::vector<std::string> notes;  ///< what is worth saying, each a sentence
};

struct LoadReport {
  double share = 0.0;  ///< of a core that the diagnosis takes, over the last seconds
  std::int64_t deepest = 0;  ///< ticks that have waited, at most
  std::int64_t room = 0;     ///< for ticks that wait
};

/// What has changed.
struct LiveEvent {
  double time = 0.0;  ///< [s since 1970]
  std::string kind;   ///< of the verdict, or "source"
  std::string words;
};

struct LiveState {
  std::string setup;
  double started = 0.0;  ///< of the watch [s since 1970]
  double now = 0.0;      ///< [s since 1970]
  Verdict verdict;
  SourceReport source;
  LoadReport load;
  bool looked = false;           ///< whether there is a look
  Finding look;                  ///< the last
  std::deque<LiveEvent> events;  ///< the latest last
  int picture = 0;               ///< another one has another number; 0: there is none
};

/// What a fault is, in words, and what it is when nothing is wrong.
struct FaultMeaning {
  std::string name;
  std::string meaning;  ///< "damping of X"
  double healthy = 1.0;
};

nlohmann::json ToJson(const std::deque<LiveEvent>& events);

/// Schema "mjdiag.watch/1", docs/watch.md.
nlohmann::json ToJson(const LiveState& state, const std::vector<FaultMeaning>& faults);

/// The same for Prometheus, as text; names in docs/watch.md.
std::string Metrics(const LiveState& state);

}  // namespace mjdiag
