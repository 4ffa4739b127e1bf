#include "mjdiag/watch/live_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/processor_time.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/watch/event_log.h"
#include "mjdiag/watch/history_json.h"
#include "mjdiag/watch/judge/history.h"
#include "mjdiag/watch/stream/tick_order.h"

namespace mjdiag {
namespace {

constexpr const char* kHistoryFile = "watch.history";
/// Between two states that pages are told [s].
constexpr double kTellEvery = 0.2;
/// A source is silent that has sent nothing for so long [s].
constexpr double kSilence = 1.0;
/// Without a verdict on a machine that runs [s].
constexpr double kTooLong = 10.0;
/// Time in which ticks gather that are judged at once.
constexpr std::chrono::milliseconds kGather{10};
constexpr double kTakePatience = 0.05;  // s
/// Over which a load is taken [s].
constexpr double kLoadOver = 2.0;
constexpr std::size_t kShownEvents = 50;

std::string SourceWords(const SourceReport& source) {
  switch (source.state) {
    case SourceState::kWaiting:
      return "Nothing has come in yet.";
    case SourceState::kRunning:
      return "Ticks come in.";
    case SourceState::kSilent:
      return "No more ticks come in.";
    case SourceState::kOtherRate:
      return "Ticks come in at another rate than the setup's; they are not judged.";
  }
  return "";
}

}  // namespace

class LiveWatch::Work final : public OrderedSink {
 public:
  Work(const Machine& machine, const PreparedDiagnosis& prepared,
       const WatchOptions& options)
      : options_(options),
        layout_(LayoutOf(machine.setup())),
        history_(HistoryQuantities(prepared.design)),
        judge_(machine, prepared, options.judge,
               [this](const Finding& look) { See(look); }),
        order_(options.order, *this),
        clock_(layout_.sample_time, IsLive(options.source)),
        queue_(
            layout_.channels.size(),
            static_cast<std::size_t>(std::lround(options.queue / layout_.sample_time)),
            IsLive(options.source) ? TickQueue::WhenFull::kLose
                                   : TickQueue::WhenFull::kWait,
            counts_),
        events_(options) {
    state_.setup = machine.setup().name;
    state_.started = state_.source.since = WallClock();
    state_.load.room = static_cast<std::int64_t>(queue_.capacity());
    if (!options_.folder.empty()) Restore();
    server_ = std::make_unique<LiveServer>(options_.server, options_.page, Answers());
    source_ = OpenSource(options_.source, layout_, options_.login, queue_, counts_);
    state_.source.name = source_->Name();
    keeper_thread_ = std::thread([this] { Keep(); });
  }

  ~Work() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
      keep_.notify_all();
    }
    queue_.Close();
    keeper_thread_.join();
  }

  const std::string& url() const { return server_->url(); }

  void Run(const std::function<bool()>& ended) {
    TickBlock block;
    load_since_ = WallClock();
    load_seconds_ = ThreadTime();
    while (!ended()) {
      const bool last = source_->ended();  // before what it left is taken
      queue_.Take(kTakePatience, block);
      for (std::size_t k = 0; k < block.size(); ++k) {
        order_.Add(block.heads[k], block.ValuesOf(k, layout_.channels.size()));
      }
      if (last && block.size() == 0) break;
      const double now = WallClock();
      if (block.size() > 0) heard_ = now;
      order_.Pass(now);
      UpdateSource(now);
      Tell(now);
      if (2 * block.size() < queue_.capacity()) std::this_thread::sleep_for(kGather);
    }
    order_.Pass(std::numeric_limits<double>::infinity());
    Tell(std::numeric_limits<double>::infinity());
    Save();
  }

  LiveState state() const {
    const std::lock_guard lock(mutex_);
    LiveState state = state_;
    state.now = WallClock();
    return state;
  }

  void OnNewRun() override {
    clock_.Begin();
    judge_.OnNewRun();
  }
  void OnMissing(std::int64_t ticks) override { judge_.OnMissing(ticks); }
  void OnTick(const TickHead& head, std::span<const double> values) override {
    clock_.Add(head);
    last_tick_ = head.arrived;
    if (!clock_.wrong_rate()) return judge_.OnTick(head, values);
    // What it saw of them means nothing.
    judge_.OnNewRun();
  }

 private:
  void Restore() {
    MakeOutputFolder(options_.folder);
    const std::filesystem::path file = options_.folder / kHistoryFile;
    if (!std::filesystem::exists(file)) return;
    nlohmann::json kept;
    try {
      kept = history_.Restore(ReadTextFile(file), file.string());
      if (kept.at("setup") == state_.setup) {
        keeper_.Resume(VerdictFromJson(kept.at("verdict")));
        for (const nlohmann::json& event : kept.at("events")) {
          state_.events.push_back(
              {event.at("time"), event.at("kind"), event.at("words")});
        }
        state_.verdict = keeper_.now();
        return;
      }
    } catch (const OtherHistory&) {
      throw;
    } catch (const std::exception& error) {
      std::filesystem::path aside = file;
      aside += ".damaged";
      std::filesystem::rename(file, aside);
      options_.on_note(std::string(error.what()) + "; put aside as " + aside.string());
      return;
    }
    throw OtherHistory(file.string(),
                       "it is of '" + kept.at("setup").get<std::string>() + "'",
                       "the history of '" + state_.setup + "', or another --out");
  }

  LiveAnswers Answers() {
    return {[this] { return StateText(); },
            [this](std::size_t level, double from) {
              return HistoryText(history_, level, from);
            },
            [this] { return Metrics(state()); },
            [this] {
              const std::lock_guard lock(mutex_);
              return picture_;
            }};
  }

  std::string StateText() const { return ToJson(state(), options_.faults).dump(); }

  /// From the judge.
  void See(const Finding& look) {
    look_is_early_ = look.kind == VerdictKind::kSettling;
    if (!look_is_early_) judged_ = look.time;
    history_.Add(look.time, HistoryValuesOf(look));
    const std::optional<VerdictChange> change = keeper_.Take(look);
    {
      const std::lock_guard lock(mutex_);
      state_.look = look;
      state_.looked = true;
      state_.verdict = keeper_.now();
      if (change) {
        AddEvent({look.time, NameOf(change->now.kind), change->now.words});
        keep_.notify_all();
      }
    }
    if (change) events_.Tell(VerdictEvent(look.time, *change));
    Tell(WallClock());
  }

  /// With the mutex held.
  void AddEvent(LiveEvent event) {
    state_.events.push_back(std::move(event));
    if (state_.events.size() > kShownEvents) state_.events.pop_front();
  }

  SourceState SourceStateAt(double now) const {
    if (last_tick_ == 0.0) return SourceState::kWaiting;
    // What has waited here was no silence of the source.
    if (now - std::max(last_tick_, heard_) > kSilence) return SourceState::kSilent;
    return clock_.wrong_rate() ? SourceState::kOtherRate : SourceState::kRunning;
  }

  void UpdateSource(double now) {
    std::unique_lock lock(mutex_);
    SourceReport& source = state_.source;
    const SourceState before = std::exchange(source.state, SourceStateAt(now));
    source.last_tick = last_tick_;
    source.packets = counts_.packets;
    source.bytes = counts_.bytes;
    source.ticks = counts_.ticks;
    source.nonsense = counts_.nonsense;
    source.last_nonsense = counts_.last_nonsense();
    source.no_room = counts_.no_room;
    source.kernel = counts_.kernel;
    source.order = order_.counts();
    source.runs = judge_.runs();
    source.clock = clock_.report();
    source.notes = clock_.Notes();
    if (look_is_early_ && now - judged_ > kTooLong &&
        source.state == SourceState::kRunning) {
      source.notes.push_back(
          "Gaps come too often: the diagnosis begins anew behind every one, and needs "
          "two seconds before it says anything.");
    }
    if (const std::string trouble = source_->Trouble(); !trouble.empty()) {
      source.notes.push_back(trouble);
    }
    UpdateLoad(now);
    if (source.state == before) return;
    judged_ = now;
    source.since = now;
    AddEvent({now, "source", SourceWords(source)});
    const WatchEvent event = SourceEvent(now, source, SourceWords(source));
    lock.unlock();
    events_.Tell(event);
  }

  /// With the mutex held.
  void UpdateLoad(double now) {
    state_.load.deepest = static_cast<std::int64_t>(queue_.deepest());
    if (now - load_since_ < kLoadOver) return;
    const double seconds = ThreadTime();
    state_.load.share = (seconds - load_seconds_) / (now - load_since_);
    load_since_ = now;
    load_seconds_ = seconds;
    if (state_.source.no_room == lost_before_) return;
    lost_before_ = state_.source.no_room;
    state_.source.notes.push_back(
        "The diagnosis is behind: " + std::to_string(lost_before_) +
        " ticks had to be left out so far.");
  }

  void Tell(double now) {
    if (now - told_ < kTellEvery && now >= told_) return;
    told_ = now;
    if (server_->readers() > 0) server_->Tell(StateText());
  }

  // ---- the keeper's thread

  void Keep() {
    double saved = WallClock();
    std::optional<std::vector<std::string>> drawn;
    std::unique_lock lock(mutex_);
    while (!stop_) {
      const std::vector<std::string> names = state_.verdict.names;
      if (options_.draw && drawn != names) {
        lock.unlock();
        Draw(names);
        drawn = names;
        lock.lock();
        continue;
      }
      keep_.wait_for(lock, std::chrono::seconds(1));
      if (WallClock() - saved < options_.save_every && WallClock() >= saved) continue;
      lock.unlock();
      Save();
      saved = WallClock();
      lock.lock();
    }
  }

  void Draw(const std::vector<std::string>& names) {
    std::string picture;
    try {
      picture = options_.draw(names);
    } catch (const std::exception& error) {
      // The watch goes on without.
      options_.on_note("no picture of the machine: " + std::string(error.what()));
      options_.draw = nullptr;
      return;
    }
    const std::lock_guard lock(mutex_);
    picture_ = std::move(picture);
    ++state_.picture;
  }

  void Save() {
    if (options_.folder.empty()) return;
    const LiveState now = state();
    const nlohmann::json kept = {{"setup", now.setup},
                                 {"saved", now.now},
                                 {"verdict", ToJson(now.verdict)},
                                 {"events", ToJson(now.events)}};
    const std::lock_guard lock(save_mutex_);
    try {
      WriteTextFile(options_.folder / kHistoryFile, history_.ToBytes(kept));
    } catch (const InputError& error) {
      // A full disk is no reason to stop looking.
      options_.on_note("the history is not saved: " + std::string(error.what()));
    }
  }

  WatchOptions options_;
  TickLayout layout_;
  StreamCounts counts_;
  History history_;
  VerdictKeeper keeper_;
  TickJudge judge_;
  TickOrder order_;
  StreamClock clock_;
  TickQueue queue_;
  EventLog events_;
  double last_tick_ = 0.0;
  double heard_ = 0.0;  // when anything was taken
  bool look_is_early_ = true;
  double judged_ = 0.0;  // when there was a verdict, or the source began to run
  double told_ = 0.0;
  double load_since_ = 0.0;
  double load_seconds_ = 0.0;
  std::int64_t lost_before_ = 0;

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable keep_;
  LiveState state_;
  std::string picture_;
  bool stop_ = false;

  std::mutex save_mutex_;
  std::unique_ptr<LiveServer> server_;
  std::unique_ptr<Source> source_;
  std::thread keeper_thread_;
};

LiveWatch::LiveWatch(const Machine& machine, const PreparedDiagnosis& prepared,
                     const WatchOptions& options)
    : work_(std::make_unique<Work>(machine, prepared, options)) {}
LiveWatch::~LiveWatch() = default;

const std::string& LiveWatch::url() const { return work_->url(); }
void LiveWatch::Run(const std::function<bool()>& ended) { work_->Run(ended); }
LiveState LiveWatch::state() const { return work_->state(); }

}  // namespace mjdiag
