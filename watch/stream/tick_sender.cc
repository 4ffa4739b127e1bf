#include "mjdiag/watch/stream/tick_sender.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/watch/stream/packet.h"
#include "mjdiag/watch/stream/sockets.h"

namespace mjdiag {
namespace {

/// In one frame of Ethernet.
constexpr std::size_t kFrame = 1472;
constexpr double kBatchTime = 0.01;  // s

/// Takes the bytes of a packet; whether it could.
using Transport = std::function<bool(std::string_view)>;

bool WriteAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError("stdout", std::strerror(errno), "a reader");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

Transport TransportTo(const StreamAddress& address, const MqttLogin& login) {
  switch (address.kind) {
    case StreamAddress::Kind::kProcess:
      return [](std::string_view bytes) { return WriteAll(STDOUT_FILENO, bytes); };
    case StreamAddress::Kind::kUdp: {
      auto socket =
          std::make_shared<Descriptor>(ConnectForDatagrams(address.host, address.port));
      return [socket](std::string_view bytes) {
        return send(socket->get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
               static_cast<ssize_t>(bytes.size());
      };
    }
    case StreamAddress::Kind::kMqtt: {
      std::shared_ptr<MqttClient> client = OpenMqtt(address, login);
      return [client, topic = address.topic](std::string_view bytes) {
        if (client->connected()) client->Publish(topic, std::string(bytes), false);
        return client->connected();
      };
    }
  }
  return {};
}

void AppendNumber(double value, std::string& text) {
  std::array<char, 32> digits{};
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

/// With as many digits as tell ticks apart.
void AppendTime(double time, std::string& text) {
  std::array<char, 48> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(),
                                          time, std::chars_format::fixed, 7);
  text.append(digits.data(), end);
}

class BatchSender final : public TickSender {
 public:
  BatchSender(const StreamAddress& address, const TickLayout& layout,
              const MqttLogin& login, const SendOptions& options)
      : layout_(layout),
        options_(options),
        transport_(TransportTo(address, login)),
        stream_(std::random_device()()) {
    const std::size_t repeats = options.twice ? 2 : 1;
    const int room = TicksThatFit(kFrame, layout.channels.size() * repeats);
    const int most = TicksThatFit(kMostPacketBytes, layout.channels.size() * repeats);
    const int wanted =
        std::max(1, static_cast<int>(std::lround(kBatchTime / layout.sample_time)));
    batch_ = options.batch > 0 ? options.batch : std::min(wanted, room);
    if (batch_ > most) {
      throw InputError("ticks in a packet", std::to_string(batch_),
                       std::to_string(most) + " at most, which fill it");
    }
    if (options.format == TickFormat::kLines &&
        address.kind == StreamAddress::Kind::kProcess) {
      AppendNames();
      transport_(bytes_);
    }
  }

  void Add(std::span<const double> values, double time) override {
    if (waiting_ == 0) first_time_ = time;
    values_.insert(values_.end(), values.begin(), values.end());
    if (options_.format == TickFormat::kLines) AppendLine(values, time);
    ++waiting_;
    if (waiting_ == batch_) Flush();
  }

  void Flush() override {
    if (waiting_ == 0) return;
    if (options_.format == TickFormat::kPackets) {
      bytes_.clear();
      AppendPackets();
    } else {
      bytes_ = options_.twice ? before_lines_ + lines_ : lines_;
      before_lines_ = std::move(lines_);
      lines_.clear();
    }
    refused_ += transport_(bytes_) ? 0 : 1;
    number_ += waiting_;
    waiting_ = 0;
    values_.clear();
  }

  int batch() const override { return batch_; }
  std::int64_t refused() const override { return refused_; }

 private:
  PacketHead Head(std::int64_t number, double time, std::size_t ticks) const {
    return {stream_, number, std::llround(1e9 * time),
            static_cast<std::uint16_t>(ticks),
            static_cast<std::uint8_t>(layout_.channels.size())};
  }

  void AppendPackets() {
    const std::size_t width = layout_.channels.size();
    if (options_.twice && !before_.empty()) {
      const std::size_t ticks = before_.size() / width;
      AppendPacket(
          Head(number_ - static_cast<std::int64_t>(ticks), before_time_, ticks),
          before_, bytes_);
    }
    AppendPacket(Head(number_, first_time_, static_cast<std::size_t>(waiting_)),
                 values_, bytes_);
    before_ = values_;
    before_time_ = first_time_;
  }

  void AppendNames() {
    bytes_ = "time [s]";
    for (const TickChannel& channel : layout_.channels) {
      bytes_ += "," + channel.name + " [" + channel.unit + "]";
    }
    bytes_ += "\n";
  }

  void AppendLine(std::span<const double> values, double time) {
    AppendTime(time, lines_);
    for (const double value : values) {
      lines_ += ',';
      if (std::isfinite(value)) AppendNumber(value, lines_);
    }
    lines_ += '\n';
  }

  const TickLayout& layout_;
  SendOptions options_;
  Transport transport_;
  std::uint32_t stream_;
  int batch_ = 1;
  int waiting_ = 0;
  std::int64_t number_ = 0;  // of the first that waits
  double first_time_ = 0.0;
  double before_time_ = 0.0;
  std::vector<double> values_;
  std::vector<double> before_;  // of the packet before
  std::string lines_;
  std::string before_lines_;
  std::string bytes_;
  std::int64_t refused_ = 0;
};

}  // namespace

std::unique_ptr<TickSender> OpenSender(const StreamAddress& address,
                                       const TickLayout& layout, const MqttLogin& login,
                                       const SendOptions& options) {
  if (layout.channels.size() > kMostChannels) {
    throw InputError("stream", std::to_string(layout.channels.size()) + " channels",
                     std::to_string(kMostChannels) + " at most");
  }
  return std::make_unique<BatchSender>(address, layout, login, options);
}

}  // namespace mjdiag
