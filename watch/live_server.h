#pragma once
// The page that a maintenance team leaves open, and what else the watch tells over HTTP.
// Whoever asks can look and nothing else: there is nothing that writes.
//
//   /              the page: one document, which asks no other server for anything
//   /events        its server-sent events: "state", a few times a second
//   /state.json    the same once (live_state.h)
//   /history.json  ?level=0..3&from=SECONDS: rows of the history
//   /picture.png   the machine with the worn part marked
//   /metrics       for Prometheus
//
// It listens on this machine only unless it has a token, which every request then has to
// bring: "Authorization: Bearer TOKEN", or ?token=TOKEN where no header can be set. There
// is no TLS in it; beyond a trusted network a proxy in front of it has to have that.

#include <functional>
#include <memory>
#include <string>

namespace mjdiag {

/// What the page is made of besides its own script: as reports look.
struct PageParts {
  std::string style;        ///< CSS
  std::string plot_script;  ///< dygraphs
  std::string plot_style;
};

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;       ///< 0: any that is free
  std::string token;  ///< empty: none is asked for
  std::string title;
};

/// Whom the server asks; from any of its threads.
struct LiveAnswers {
  std::function<std::string()> state;
  /// Of a level (history.h), from a time on.
  std::function<std::string(std::size_t level, double from)> history;
  std::function<std::string()> metrics;
  std::function<std::string()> picture;  ///< PNG; empty: there is none
};

class LiveServer {
 public:
  /// Begins to listen. InputError if the port is in use or the host none of this machine,
  /// or if it is open to other machines and there is no token.
  LiveServer(const ServerOptions& options, const PageParts& parts, LiveAnswers answers);
  /// Ends all connections.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// "http://127.0.0.1:9871/"
  const std::string& url() const;
  /// Sends that state to every page that is open. Does not wait for any.
  void Tell(const std::string& state);
  /// Pages that are open.
  int readers() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether only this machine can reach it.
bool IsLoopback(const std::string& host);

}  // namespace mjdiag
