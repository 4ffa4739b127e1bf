#include "mjdiag/watch/stream/address.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

constexpr int kMqttPort = 1883;
constexpr const char* kLoopback = "127.0.0.1";
constexpr double kHighestPort = 65535.0;

bool TakePrefix(std::string_view prefix, std::string_view& text) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

int ParsePort(std::string_view text, const std::string& what) {
  const auto number = ParseNumber(text);
  if (!number || *number < 0.0 || *number > kHighestPort ||
      *number != std::floor(*number)) {
    throw InputError(what, "no port '" + std::string(text) + "'", "0 to 65535");
  }
  return static_cast<int>(*number);
}

}  // namespace

HostPort ParseHostPort(std::string_view text, int fallback, const std::string& what) {
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close != text.npos && text.rfind('[') == 0) {
      const std::string host(text.substr(1, close - 1));
      const std::string_view rest = text.substr(close + 1);
      if (rest.empty() && fallback != 0) return {host, fallback};
      if (rest.starts_with(':')) return {host, ParsePort(rest.substr(1), what)};
    }
    throw InputError(what, "'" + std::string(text) + "'", "[ADDRESS]:PORT");
  }
  if (text.find_first_of("[]") != text.npos) {
    throw InputError(what, "'" + std::string(text) + "'", "[ADDRESS]:PORT");
  }
  const std::size_t colon = text.rfind(':');
  if (colon != text.npos) {
    return {std::string(text.substr(0, colon)),
            ParsePort(text.substr(colon + 1), what)};
  }
  const bool digits = !text.empty() && std::ranges::all_of(text, [](char c) {
    return c >= '0' && c <= '9';
  });
  if (fallback == 0 || digits) return {"", ParsePort(text, what)};
  return {std::string(text), fallback};
}

StreamAddress ParseStreamAddress(std::string_view text, const std::string& what) {
  StreamAddress address;
  std::string_view rest = text;
  if (text == "-" || text == "stdin" || text == "stdout") return address;
  const std::string named = what + " " + std::string(text);
  if (TakePrefix("udp:", rest)) {
    const auto [host, port] = ParseHostPort(rest, 0, named);
    if (port == 0) throw InputError(named, "port 0", "1 to 65535");
    return {StreamAddress::Kind::kUdp, host.empty() ? kLoopback : host, port, ""};
  }
  if (TakePrefix("mqtt:", rest)) {
    TakePrefix("//", rest);
    const std::size_t slash = rest.find('/');
    if (slash != rest.npos && slash > 0 && slash + 1 < rest.size()) {
      const auto [host, port] = ParseHostPort(rest.substr(0, slash), kMqttPort, named);
      return {StreamAddress::Kind::kMqtt, host.empty() ? kLoopback : host, port,
              std::string(rest.substr(slash + 1))};
    }
  }
  throw InputError(what, "'" + std::string(text) + "'",
                   "stdin, udp:[HOST:]PORT or mqtt:HOST[:PORT]/TOPIC");
}

std::string AddressText(const StreamAddress& address) {
  const bool six = address.host.find(':') != std::string::npos;
  const std::string place = (six ? "[" + address.host + "]" : address.host) + ":" +
                            std::to_string(address.port);
  switch (address.kind) {
    case StreamAddress::Kind::kProcess:
      return "stdin";
    case StreamAddress::Kind::kUdp:
      return "udp:" + place;
    case StreamAddress::Kind::kMqtt:
      return "mqtt:" + place + "/" + address.topic;
  }
  return "";
}

}  // namespace mjdiag
