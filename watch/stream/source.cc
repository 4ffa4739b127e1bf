#include "mjdiag/watch/stream/source.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <string_view>
#include <thread>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/watch/stream/packet.h"
#include "mjdiag/watch/stream/sockets.h"
#include "mjdiag/watch/stream/tick_decoder.h"

namespace mjdiag {
namespace {

/// After which a source looks whether it shall end [ms].
constexpr int kLookEvery = 100;
constexpr std::size_t kReadBytes = 1U << 16;

/// Whether something can be read, within kLookEvery.
bool WaitForBytes(int descriptor) {
  pollfd waiting{descriptor, POLLIN, 0};
  return poll(&waiting, 1, kLookEvery) > 0;
}

class DescriptorSource final : public Source {
 public:
  DescriptorSource(int descriptor, const TickLayout& layout, TickQueue& queue,
                   StreamCounts& counts)
      : queue_(queue),
        decoder_(layout, queue, counts),
        thread_([this, descriptor] { Read(descriptor); }) {}
  ~DescriptorSource() override {
    stop_ = true;
    queue_.Close();
    thread_.join();
  }

  std::string Name() const override { return "stdin"; }
  bool ended() const override { return ended_; }

 private:
  void Read(int descriptor) {
    std::vector<char> bytes(kReadBytes);
    while (!stop_) {
      if (!WaitForBytes(descriptor)) continue;
      const ssize_t count = read(descriptor, bytes.data(), bytes.size());
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (count <= 0) break;
      decoder_.TakePart({bytes.data(), static_cast<std::size_t>(count)}, WallClock());
    }
    decoder_.EndStream(WallClock());
    ended_ = true;
  }

  TickQueue& queue_;
  TickDecoder decoder_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

class UdpSource final : public Source {
 public:
  UdpSource(const StreamAddress& address, const TickLayout& layout, TickQueue& queue,
            StreamCounts& counts)
      : name_(AddressText(address)),
        socket_(ListenForDatagrams(address.host, address.port)),
        counts_(counts),
        decoder_(layout, queue, counts),
        thread_([this] { Receive(); }) {}
  ~UdpSource() override {
    stop_ = true;
    thread_.join();
  }

  std::string Name() const override { return name_; }

 private:
  void Receive() {
    std::vector<char> bytes(kMostPacketBytes + 1);
    while (!stop_) {
      if (WaitForBytes(socket_.get())) ReceiveOne(bytes);
    }
  }

  void ReceiveOne(std::vector<char>& bytes) {
    sockaddr_storage sender{};
    std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control{};
    iovec part{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_name = &sender;
    message.msg_namelen = sizeof sender;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = recvmsg(socket_.get(), &message, MSG_DONTWAIT);
    if (count < 0) return;
    for (cmsghdr* part_of = CMSG_FIRSTHDR(&message); part_of != nullptr;
         part_of = CMSG_NXTHDR(&message, part_of)) {
      if (part_of->cmsg_level != SOL_SOCKET || part_of->cmsg_type != SO_RXQ_OVFL)
        continue;
      std::uint32_t dropped = 0;
      std::memcpy(&dropped, CMSG_DATA(part_of), sizeof dropped);
      counts_.kernel = dropped;
    }
    const std::string_view from(reinterpret_cast<const char*>(&sender),
                                message.msg_namelen);
    decoder_.TakeMessage(
        {bytes.data(), static_cast<std::size_t>(count)},
        static_cast<std::uint32_t>(std::hash<std::string_view>()(from)), WallClock());
  }

  std::string name_;
  Descriptor socket_;
  StreamCounts& counts_;
  TickDecoder decoder_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

class MqttSource final : public Source {
 public:
  MqttSource(const StreamAddress& address, const TickLayout& layout,
             const MqttLogin& login, TickQueue& queue, StreamCounts& counts)
      : name_(AddressText(address)),
        decoder_(layout, queue, counts),
        client_(OpenMqtt(address, login, [this](std::string_view message) {
          decoder_.TakeMessage(message, 0, WallClock());
        })) {}

  std::string Name() const override { return name_; }
  std::string Trouble() const override { return client_->Trouble(); }

 private:
  std::string name_;
  TickDecoder decoder_;
  std::unique_ptr<MqttClient> client_;
};

}  // namespace

bool IsLive(const StreamAddress& address) {
  return address.kind != StreamAddress::Kind::kProcess;
}

std::unique_ptr<Source> OpenDescriptor(int descriptor, const TickLayout& layout,
                                       TickQueue& queue, StreamCounts& counts) {
  return std::make_unique<DescriptorSource>(descriptor, layout, queue, counts);
}

std::unique_ptr<Source> OpenSource(const StreamAddress& address,
                                   const TickLayout& layout, const MqttLogin& login,
                                   TickQueue& queue, StreamCounts& counts) {
  if (layout.channels.size() > kMostChannels) {
    throw InputError("stream", std::to_string(layout.channels.size()) + " channels",
                     std::to_string(kMostChannels) + " at most");
  }
  switch (address.kind) {
    case StreamAddress::Kind::kProcess:
      return OpenDescriptor(STDIN_FILENO, layout, queue, counts);
    case StreamAddress::Kind::kUdp:
      return std::make_unique<UdpSource>(address, layout, queue, counts);
    case StreamAddress::Kind::kMqtt:
      return std::make_unique<MqttSource>(address, layout, login, queue, counts);
  }
  return nullptr;
}

}  // namespace mjdiag
