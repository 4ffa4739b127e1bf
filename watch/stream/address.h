#pragma once
// Where a stream comes from or goes to, as it is written on a command line:
//
//   stdin, stdout, -        this process
//   udp:[HOST:]PORT         datagrams; HOST to listen on (default 127.0.0.1) or to send to
//   mqtt:HOST[:PORT]/TOPIC  messages of a broker (default port 1883)

#include <string>
#include <string_view>

namespace mjdiag {

struct StreamAddress {
  enum class Kind { kProcess, kUdp, kMqtt };
  Kind kind = Kind::kProcess;
  std::string host;
  int port = 0;
  std::string topic;
};

/// @param what  for messages, for example "--source"
/// InputError on anything else.
StreamAddress ParseStreamAddress(std::string_view text, const std::string& what);

std::string AddressText(const StreamAddress& address);

/// HOST:PORT, [HOST]:PORT of IPv6, or PORT alone.
struct HostPort {
  std::string host;  ///< empty: none was given
  int port = 0;
};
/// @param fallback  port where none is given; 0: one has to be
/// InputError that begins with `what`.
HostPort ParseHostPort(std::string_view text, int fallback, const std::string& what);

}  // namespace mjdiag
