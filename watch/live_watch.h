#pragma once
// A diagnosis beside a running machine: ticks from a source, a judge, and all who are
// told. Four threads work in it, and none waits for another: the source fills a queue,
// the caller's thread judges, a keeper draws pictures and writes the history, and the
// server answers pages.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/watch/judge/tick_judge.h"
#include "mjdiag/watch/live_server.h"
#include "mjdiag/watch/live_state.h"
#include "mjdiag/watch/stream/source.h"

namespace mjdiag {

struct WatchOptions {
  StreamAddress source;
  MqttLogin login;
  /// Where changes are published: <topic>/verdict, retained, and <topic>/events.
  std::optional<StreamAddress> publish;
  ServerOptions server;
  PageParts page;
  JudgeOptions judge;
  OrderOptions order;
  /// Folder of watch.history and events.jsonl; empty: nothing is kept.
  std::filesystem::path folder;
  double save_every = 120.0;         ///< [s]
  double queue = 8.0;                ///< [s] of ticks that may wait
  std::vector<FaultMeaning> faults;  ///< in the order of the design
  /// Draws the machine with the parts of these faults marked, as PNG; from a thread of its
  /// own. None: no pictures.
  std::function<std::string(const std::vector<std::string>& faults)> draw;
  /// One line of JSON: a verdict or the state of the source has changed (docs/watch.md).
  /// From the caller's thread.
  std::function<void(const std::string& line)> on_event;
  /// Worth telling those who started it, a sentence.
  std::function<void(const std::string& note)> on_note;
};

class LiveWatch {
 public:
  /// Opens source, server and history. The machine and what is prepared outlive it.
  /// InputError as OpenSource and LiveServer, or if the history is of another machine;
  /// one that is damaged is put aside with a note.
  LiveWatch(const Machine& machine, const PreparedDiagnosis& prepared,
            const WatchOptions& options);
  ~LiveWatch();
  LiveWatch(const LiveWatch&) = delete;
  LiveWatch& operator=(const LiveWatch&) = delete;

  const std::string& url() const;
  /// Judges until the source has ended or `ended` says so, which is asked several times a
  /// second; then writes the history.
  void Run(const std::function<bool()>& ended);
  /// As of now.
  LiveState state() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace mjdiag
