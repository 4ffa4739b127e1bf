#include "mjdiag/watch/stream/sockets.h"

#include <netdb.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// For half a second of the bonder: what a busy machine may keep the reader waiting.
constexpr int kReceiveBuffer = 4 << 20;

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses Resolve(const std::string& host, int port, bool passive,
                  const std::string& what) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV | (passive ? AI_PASSIVE : 0);
  addrinfo* found = nullptr;
  const int failure =
      getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (failure != 0) {
    throw InputError(what, gai_strerror(failure), "a host that is known here");
  }
  return {found, &freeaddrinfo};
}

}  // namespace

Descriptor ListenForDatagrams(const std::string& host, int port) {
  const std::string what = "udp:" + host + ":" + std::to_string(port);
  const Addresses addresses = Resolve(host, port, true, what);
  Descriptor made(
      socket(addresses->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, addresses->ai_protocol));
  if (made.get() < 0 ||
      bind(made.get(), addresses->ai_addr, addresses->ai_addrlen) != 0) {
    throw InputError(what, std::strerror(errno),
                     errno == EADDRINUSE ? "a port that nobody else listens on"
                                         : "an address of this machine");
  }
  // As much as the system grants.
  setsockopt(made.get(), SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
  setsockopt(made.get(), SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveBuffer,
             sizeof kReceiveBuffer);
  const int on = 1;
  setsockopt(made.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  return made;
}

Descriptor ConnectForDatagrams(const std::string& host, int port) {
  const std::string what = "udp:" + host + ":" + std::to_string(port);
  const Addresses addresses = Resolve(host, port, false, what);
  Descriptor made(
      socket(addresses->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, addresses->ai_protocol));
  if (made.get() < 0 ||
      connect(made.get(), addresses->ai_addr, addresses->ai_addrlen) != 0) {
    throw InputError(what, std::strerror(errno), "an address that can be reached");
  }
  return made;
}

}  // namespace mjdiag
