// Ranks as threads of this process, which fail, die and are asked to end.

#include "mjdiag/studies/cluster/shared_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <deque>
#include <mutex>
#include <numeric>
#include <thread>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kRuns = 200;
constexpr std::uint64_t kStudy = 7;

struct Post {
  explicit Post(int ranks) : boxes(static_cast<std::size_t>(ranks)) {}
  std::mutex mutex;
  std::vector<std::deque<RankMessage>> boxes;
};

class ThreadLink : public RankLink {
 public:
  ThreadLink(Post& post, int rank) : post_(post), rank_(rank) {}

  int rank() const override { return rank_; }
  int ranks() const override { return static_cast<int>(post_.boxes.size()); }
  void Send(int to, const std::string& bytes) override {
    const std::lock_guard lock(post_.mutex);
    post_.boxes[static_cast<std::size_t>(to)].push_back({rank_, bytes});
  }
  std::optional<RankMessage> Receive() override {
    const std::lock_guard lock(post_.mutex);
    auto& box = post_.boxes[static_cast<std::size_t>(rank_)];
    if (box.empty()) return std::nullopt;
    RankMessage message = box.front();
    box.pop_front();
    return message;
  }
  void Leave(bool together) override { left_together = together; }
  void Abort() override { std::abort(); }

  static inline std::atomic<bool> left_together = true;

 private:
  Post& post_;
  int rank_;
};

/// A job whose rank k does with a run what a test says.
class Job : public ::testing::Test {
 protected:
  using Make = std::function<void(int rank, std::int64_t run)>;

  void Run(int ranks, const Make& make, const std::function<bool(int)>& wish = {}) {
    Post post(ranks);
    std::vector<std::thread> others;
    for (int rank = 1; rank < ranks; ++rank) {
      others.emplace_back([&, rank] { Serve(post, rank, make, wish); });
    }
    const auto join = [&] {
      for (std::thread& other : others) other.join();
    };
    try {
      Lead(post, make);
    } catch (...) {
      join();
      throw;
    }
    join();
  }

  RankWork WorkOf(int rank, const Make& make) {
    return {[](const std::function<void()>& check) { check(); },
            [this, rank, make](std::int64_t run) {
              make(rank, run);
              ++made_[static_cast<std::size_t>(run)];
            }};
  }

  void Lead(Post& post, const Make& make) {
    RankTeam team(std::make_unique<ThreadLink>(post, 0));
    LeadOptions options;
    options.open.resize(kRuns);
    std::iota(options.open.begin(), options.open.end(), 0);
    options.runs = kRuns;
    options.study = kStudy;
    options.patience = patience_;
    options.tell = [this](std::int64_t made, bool) { told_ = made; };
    options.note = [this](const std::string& line) { notes_.push_back(line); };
    RunPool pool(2, WorkOf(0, make));
    LeadRuns(team, pool, options);
  }

  void Serve(Post& post, int rank, const Make& make,
             const std::function<bool(int)>& wish) {
    RankTeam team(std::make_unique<ThreadLink>(post, rank));
    team.AwaitOrder(patience_);
    if (rank == dead_) return;
    RunPool pool(2, WorkOf(rank, make));
    const auto rest =
        MakeRuns(team, pool, kStudy, patience_, [&] { return wish && wish(rank); });
    ReportClosed(team, rest);
    // As ranks of a plan do: until then the lead may wait for one that died.
    team.Leave(team.AwaitOrder(2.0 * patience_));
  }

  std::vector<int> Made() const { return {made_.begin(), made_.end()}; }

  std::vector<std::atomic<int>> made_ = std::vector<std::atomic<int>>(kRuns);
  std::vector<std::string> notes_;
  std::int64_t told_ = 0;
  double patience_ = 30.0;
  int dead_ = -1;
};

void Rest(int, std::int64_t) {
  std::this_thread::sleep_for(std::chrono::microseconds(200));
}

TEST_F(Job, MakesEveryRunOnce) {
  std::array<std::atomic<int>, 3> by_rank{};
  Run(3, [&](int rank, std::int64_t run) {
    ++by_rank[static_cast<std::size_t>(rank)];
    Rest(rank, run);
  });
  EXPECT_THAT(Made(), Each(1));
  for (const auto& runs : by_rank) EXPECT_GE(runs, 1);
  EXPECT_EQ(told_, kRuns);
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_TRUE(ThreadLink::left_together);
}

TEST_F(Job, RepeatsARunThatThrewElsewhere) {
  std::atomic<bool> threw = false;
  Run(3, [&](int rank, std::int64_t run) {
    if (rank == 2 && !threw.exchange(true)) throw InputError("no room on this disk");
    Rest(rank, run);
  });
  EXPECT_TRUE(threw);
  EXPECT_THAT(Made(), Each(Ge(1)));
  EXPECT_THAT(notes_, Contains(HasSubstr("rank 2 makes no more runs: no room")));
}

TEST_F(Job, EndsWithARunThatThrowsTwice) {
  const std::string message = test::MessageOf<InputError>([&] {
    Run(3, [](int, std::int64_t run) {
      if (run == 5) throw InputError("run 5 cannot be made");
      Rest(0, run);
    });
  });
  EXPECT_EQ(message, "run 5 cannot be made");
}

TEST_F(Job, MakesTheRunsOfARankThatDied) {
  patience_ = 1.5;
  dead_ = 1;
  Run(3, Rest);
  EXPECT_THAT(Made(), Each(1));
  EXPECT_FALSE(ThreadLink::left_together);
  ThreadLink::left_together = true;
}

TEST_F(Job, GoesOnWithoutARankThatWasAskedToEnd) {
  Run(3, Rest, [](int rank) { return rank == 1; });
  EXPECT_THAT(Made(), Each(Ge(1)));
  EXPECT_THAT(notes_, Contains("rank 1 makes no more runs: was asked to end"));
}

}  // namespace
}  // namespace mjdiag
