#include "mjdiag/watch/live_server.h"

#include <httplib.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <string_view>
#include <thread>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/watch/live_page.h"

namespace mjdiag {
namespace {

/// Pages that may be open at once; each has a thread, which sleeps nearly always.
constexpr int kMostReaders = 64;
constexpr std::size_t kThreads = kMostReaders + 16;
/// Of a page whose machine says nothing: so that either end notices that the other is
/// gone.
constexpr std::chrono::seconds kKeepAlive{5};
constexpr std::size_t kMostPayload = 1024;  // bytes; nobody has anything to send

constexpr int kUnauthorized = 401;
constexpr int kForbidden = 403;
constexpr int kNotFound = 404;
constexpr int kMethodNotAllowed = 405;
constexpr int kUnavailable = 503;

using Handling = httplib::Server::HandlerResponse;

/// Takes the same time wherever they differ.
bool SameText(std::string_view a, std::string_view b) {
  unsigned char difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i] ^ (b.empty() ? 0 : b[i % b.size()]));
  }
  return difference == 0;
}

std::string HostOf(const std::string& header) {
  const std::size_t end = header.starts_with('[') ? header.find(']') : header.find(':');
  return header.substr(header.starts_with('[') ? 1 : 0,
                       end - (header.starts_with('[') ? 1 : 0));
}

/// The latest state, for all who wait for it.
class Board {
 public:
  void Post(const std::string& state) {
    const std::lock_guard lock(mutex_);
    state_ = state;
    ++number_;
    changed_.notify_all();
  }
  void Close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  /// Waits for one that is newer than `number`; false: there will be none.
  bool Wait(std::uint64_t& number, std::string& state) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kKeepAlive, [&] { return number_ != number || closed_; });
    if (closed_) return false;
    state = number_ == number ? "" : state_;
    number = number_;
    return true;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string state_;
  std::uint64_t number_ = 0;
  bool closed_ = false;
};

void Refuse(int status, const std::string& why, httplib::Response& response) {
  response.status = status;
  response.set_content(why + "\n", "text/plain");
}

}  // namespace

bool IsLoopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

struct LiveServer::State {
  ServerOptions options;
  LiveAnswers answers;
  std::string page;
  std::string url;
  Board board;
  std::atomic<int> readers = 0;
  httplib::Server server;
  std::atomic<bool> ended = false;
  std::thread thread;

  void Configure();
  void Listen();
  Handling Check(const httplib::Request& request, httplib::Response& response) const;
  void OpenEvents(httplib::Response& response);
  void AnswerHistory(const httplib::Request& request, httplib::Response& response);
};

void LiveServer::State::Configure() {
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  // Not the default, with which two watches could share a port.
  server.set_socket_options([](socket_t socket) {
    const int on = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  });
  server.set_payload_max_length(kMostPayload);
  server.set_tcp_nodelay(true);
  server.set_default_headers({
      {"Cache-Control", "no-store"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "SAMEORIGIN"},
      {"Referrer-Policy", "no-referrer"},
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
       "img-src 'self' data:; connect-src 'self'"},
  });
  server.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        return Check(request, response);
      });
  const auto text = [](const std::function<std::string()>& answer, const char* type) {
    return [&answer, type](const httplib::Request&, httplib::Response& response) {
      response.set_content(answer(), type);
    };
  };
  server.Get("/", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(page, "text/html; charset=utf-8");
  });
  server.Get("/state.json", text(answers.state, "application/json"));
  server.Get("/metrics", text(answers.metrics, "text/plain; version=0.0.4"));
  server.Get("/history.json",
             [this](const httplib::Request& request, httplib::Response& response) {
               AnswerHistory(request, response);
             });
  server.Get("/picture.png",
             [this](const httplib::Request&, httplib::Response& response) {
               const std::string png = answers.picture();
               if (png.empty())
                 return Refuse(kNotFound, "there is no picture", response);
               response.set_content(png, "image/png");
             });
  server.Get("/events", [this](const httplib::Request&, httplib::Response& response) {
    OpenEvents(response);
  });
}

Handling LiveServer::State::Check(const httplib::Request& request,
                                  httplib::Response& response) const {
  if (request.method != "GET" && request.method != "HEAD") {
    response.set_header("Allow", "GET, HEAD");
    Refuse(kMethodNotAllowed, "there is nothing to be written here", response);
    return Handling::Handled;
  }
  if (options.token.empty()) {
    // A page from elsewhere may have its own name point here; it does not get in.
    if (IsLoopback(HostOf(request.get_header_value("Host"))))
      return Handling::Unhandled;
    Refuse(kForbidden, "ask for this machine by its own name, localhost", response);
    return Handling::Handled;
  }
  if (SameText(request.get_header_value("Authorization"), "Bearer " + options.token) ||
      SameText(request.get_param_value("token"), options.token)) {
    return Handling::Unhandled;
  }
  response.set_header("WWW-Authenticate", "Bearer");
  Refuse(kUnauthorized, "the token is missing or another one", response);
  return Handling::Handled;
}

void LiveServer::State::AnswerHistory(const httplib::Request& request,
                                      httplib::Response& response) {
  const auto level = ParseNumber(request.get_param_value("level"));
  const auto from = ParseNumber(request.get_param_value("from"));
  const double wanted = level.value_or(0.0);
  if (!(wanted >= 0.0) || !(wanted < 1e3)) {
    return Refuse(kNotFound, "there is no such level", response);
  }
  const std::string rows =
      answers.history(static_cast<std::size_t>(wanted), from.value_or(0.0));
  if (rows.empty()) return Refuse(kNotFound, "there is no such level", response);
  response.set_content(rows, "application/json");
}

void LiveServer::State::OpenEvents(httplib::Response& response) {
  if (++readers > kMostReaders) {
    --readers;
    return Refuse(kUnavailable, "too many pages are open", response);
  }
  auto seen = std::make_shared<std::uint64_t>(0);
  response.set_header("X-Accel-Buffering", "no");  // proxies keep events back otherwise
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, seen](std::size_t, httplib::DataSink& sink) {
        std::string state;
        if (!board.Wait(*seen, state)) return false;
        const std::string event = state.empty()
                                      ? ": still here\n\n"
                                      : "event: state\ndata: " + state + "\n\n";
        return sink.write(event.data(), event.size());
      },
      [this](bool) { --readers; });
}

void LiveServer::State::Listen() {
  const std::string where = options.host + ":" + std::to_string(options.port);
  if (options.token.empty() && !IsLoopback(options.host)) {
    throw InputError("--listen " + where, "other machines could look without a token",
                     "--token, or 127.0.0.1");
  }
  errno = 0;
  const int port = options.port == 0 ? server.bind_to_any_port(options.host)
                   : server.bind_to_port(options.host, options.port) ? options.port
                                                                     : -1;
  if (port < 0) {
    const bool in_use = errno == EADDRINUSE;
    throw InputError("--listen " + where,
                     in_use ? "the port is in use" : "it cannot be listened on",
                     in_use ? "one that is free" : "an address of this machine");
  }
  const bool six = options.host.find(':') != std::string::npos;
  url = "http://" + (six ? "[" + options.host + "]" : options.host) + ":" +
        std::to_string(port) + "/";
  thread = std::thread([this] {
    server.listen_after_bind();
    ended = true;
  });
}

LiveServer::LiveServer(const ServerOptions& options, const PageParts& parts,
                       LiveAnswers answers)
    : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->answers = std::move(answers);
  state_->page = LivePage(options.title, parts);
  state_->Configure();
  state_->Listen();
}

LiveServer::~LiveServer() {
  state_->board.Close();
  // It can only be stopped once it runs.
  while (!state_->server.is_running() && !state_->ended) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  state_->server.stop();
  state_->thread.join();
}

const std::string& LiveServer::url() const { return state_->url; }
void LiveServer::Tell(const std::string& state) { state_->board.Post(state); }
int LiveServer::readers() const { return state_->readers; }

}  // namespace mjdiag
