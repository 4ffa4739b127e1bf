#pragma once
// Sockets and descriptors that close themselves.

#include <unistd.h>

#include <string>
#include <utility>

namespace mjdiag {

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  int get() const { return number_; }

 private:
  int number_ = -1;
};

/// A socket for datagrams that listens there. InputError if the port is in use or the
/// host is none of this machine.
Descriptor ListenForDatagrams(const std::string& host, int port);
/// A socket whose datagrams go there. InputError if the host is not known.
Descriptor ConnectForDatagrams(const std::string& host, int port);

}  // namespace mjdiag
