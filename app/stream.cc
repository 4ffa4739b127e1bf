#include "app/stream.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <thread>
#include <vector>

#include "app/broker.h"
#include "app/format.h"
#include "app/interrupt.h"
#include "mjdiag/plugin/runtime/late_faults.h"
#include "mjdiag/plugin/runtime/running_machine.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/watch/stream/tick.h"

namespace mjdiag::app {
namespace {

using Eigen::Index;
using Clock = std::chrono::steady_clock;

constexpr double kLongestStream = 1e9;  // s
constexpr double kFastest = 1e6;
/// From which on a stream that is late says so [s], and how often.
constexpr double kLate = 0.5;
constexpr std::chrono::seconds kSayEvery{10};

/// Keeps ticks to their times, packet by packet.
class Pace {
 public:
  Pace(double sample_time, double speed, int batch)
      : sample_time_(sample_time),
        speed_(speed),
        batch_(batch),
        start_(Clock::now()),
        start_date_(WallClock()) {}

  /// When a tick is [s since 1970].
  double TimeOf(Index tick) const {
    return start_date_ + static_cast<double>(tick) * sample_time_;
  }
  /// Before a tick is made: waits until the packet that it begins is due.
  void Await(Index tick) {
    if (speed_ == 0.0 || tick % batch_ != 0) return;
    const std::chrono::duration<double> due(static_cast<double>(tick) * sample_time_ /
                                            speed_);
    const auto time = start_ + std::chrono::duration_cast<Clock::duration>(due);
    std::this_thread::sleep_until(time);
    const double late = std::chrono::duration<double>(Clock::now() - time).count();
    if (late < kLate || Clock::now() - said_ < kSayEvery) return;
    said_ = Clock::now();
    std::fprintf(stderr, "stream: %s s behind\n", Short(late).c_str());
  }

 private:
  double sample_time_;
  double speed_;
  int batch_;
  Clock::time_point start_;
  Clock::time_point said_;
  double start_date_;
};

/// Hands every tick of the machine to a sender.
class Tap final : public TickObserver {
 public:
  explicit Tap(std::size_t channels) : values_(channels) {}

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override {
    std::ranges::copy(outputs, values_.begin());
    std::ranges::copy(inputs,
                      values_.begin() + static_cast<std::ptrdiff_t>(outputs.size()));
  }
  const std::vector<double>& values() const { return values_; }

 private:
  std::vector<double> values_;
};

Index TicksOf(const StreamOptions& options, double sample_time) {
  if (options.duration == 0.0) return std::numeric_limits<Index>::max();
  return std::llround(options.duration / sample_time);
}

void StreamMachine(const Subject& subject, const MotionOptions& motion,
                   const StreamOptions& options, TickSender& sender) {
  std::vector<std::string> notes;
  const Excitation excitation = MakeExcitation(subject.setup(), motion, notes);
  const Rates& rates = subject.setup().rates;
  Tap tap(subject.setup().channels.sensors.size() +
          subject.setup().channels.actuators.size());
  RunOptions run = subject.options;
  run.observer = &tap;
  run.repeat = true;
  const auto running = motion.linear ? StartLinear(subject.machine, excitation, run)
                                     : StartNonlinear(subject.machine, excitation, run);
  const std::vector<MachineStage> stages =
      StagesOf(subject.machine, subject.options.late_faults);
  auto stage = stages.begin();
  Pace pace(rates.tick(), options.speed, sender.batch());
  const Index ticks = TicksOf(options, rates.tick());
  for (Index tick = 0; tick < ticks && !Interrupt::IsWished(); ++tick) {
    pace.Await(tick);
    for (; stage != stages.end() && stage->tick <= tick; ++stage) {
      running->Become(stage->machine);
    }
    running->Tick();
    sender.Add(tap.values(), pace.TimeOf(tick));
  }
}

void PlayRecord(const Subject& subject, const StreamOptions& options,
                TickSender& sender) {
  std::vector<std::string> notes;
  const Record record = ReadMeasured(subject.setup(), options.play, notes);
  const Channels& channels = subject.setup().channels;
  std::vector<std::string> names = ChannelsOf(channels.sensors);
  for (const ActuatorSetup& actuator : channels.actuators) {
    names.push_back(actuator.channel);
  }
  Eigen::MatrixXd samples = SamplesOf(record, names);
  const Eigen::ArrayXX<bool> measured = MeasuredOf(record, names);
  if (measured.size() > 0) {
    samples = measured.select(samples, std::numeric_limits<double>::quiet_NaN());
  }
  Pace pace(record.sample_time(), options.speed, sender.batch());
  const Index ticks =
      std::min(record.samples(), TicksOf(options, record.sample_time()));
  for (Index tick = 0; tick < ticks && !Interrupt::IsWished(); ++tick) {
    pace.Await(tick);
    sender.Add({samples.col(tick).data(), names.size()}, pace.TimeOf(tick));
  }
}

}  // namespace

void AddStreamOptions(CLI::App& command, StreamOptions& options) {
  command.add_option(
      "--stream", options.target,
      "Run in real time, the motion again and again, and send every tick: "
      "stdout, udp:HOST:PORT or mqtt:HOST[:PORT]/TOPIC");
  command.add_option("--stream-format", options.format, "How ticks are sent")
      ->check(CLI::IsMember({"binary", "csv"}));
  command
      .add_option("--stream-for", options.duration,
                  "End after this time of the machine [s]")
      ->check(Within(0.0, kLongestStream));
  command
      .add_option("--speed", options.speed,
                  "Seconds of the machine a second; 0: as fast as it goes")
      ->check(Within(0.0, kFastest));
  command.add_option("--batch", options.send.batch, "Ticks a packet")
      ->check(CLI::Range(1, 60000));
  command.add_flag("--twice", options.send.twice,
                   "Send every tick in two packets, so that one may get lost");
  command
      .add_option("--play", options.play,
                  "Send the samples of this record instead of a simulation")
      ->excludes("--fault")
      ->excludes("--effect")
      ->excludes("--replay")
      ->excludes("--trajectory");
  AddBrokerOptions(command, options.login);
}

void Stream(const Subject& subject, const MotionOptions& motion,
            const StreamOptions& options) {
  StreamOptions wanted = options;
  TakePassword(wanted.login);
  wanted.send.format =
      options.format == "csv" ? TickFormat::kLines : TickFormat::kPackets;
  const StreamAddress address = ParseStreamAddress(options.target, "--stream");
  const TickLayout layout = LayoutOf(subject.setup());
  const auto sender = OpenSender(address, layout, wanted.login, wanted.send);
  if (address.kind != StreamAddress::Kind::kProcess) {
    std::printf(
        "%s: %s to %s, %d ticks of %s a packet\n", subject.setup().name.c_str(),
        options.play.empty() ? SubjectText(subject).c_str() : options.play.c_str(),
        mjdiag::AddressText(address).c_str(), sender->batch(),
        mjdiag::LayoutText(layout).c_str());
    std::fflush(stdout);
  }
  const Interrupt interrupt;
  if (options.play.empty()) {
    StreamMachine(subject, motion, wanted, *sender);
  } else {
    PlayRecord(subject, wanted, *sender);
  }
  sender->Flush();
}

}  // namespace mjdiag::app
