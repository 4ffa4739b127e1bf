#include "mjdiag/render/stage.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace mjdiag {
namespace {

TEST(Stage, WorksOnAllItemsInTheirOrder) {
  std::vector<int> seen;
  Stage<int> stage(2, [&](int& item) { seen.push_back(item); });
  std::vector<int> expected;
  for (int i = 0; i < 100; ++i) {
    expected.push_back(i);
    int item = i;
    stage.Push(item);
  }
  stage.Finish();
  EXPECT_EQ(seen, expected);
}

TEST(Stage, WorksWhileTheCallerGoesOn) {
  std::promise<void> next;
  Stage<int> stage(2, [&](int& item) {
    if (item == 0) next.get_future().wait();
  });
  int item = 0;
  stage.Push(item);
  item = 1;
  stage.Push(item);  // would never return if Push waited for the work
  next.set_value();
  stage.Finish();
}

TEST(Stage, HandsTheMemoryOfDoneItemsBack) {
  // What is done before the second comes in is handed back with that.
  std::promise<void> second_waits;
  std::promise<void> first_is_done;
  std::promise<void> go_on;
  const std::string first(1000, 'a');
  Stage<std::string> stage(2, [&](std::string& item) {
    if (item == first) second_waits.get_future().wait();
    if (item != "second") return;
    first_is_done.set_value();
    go_on.get_future().wait();
  });
  std::string item = first;
  stage.Push(item);
  item = "second";
  stage.Push(item);
  second_waits.set_value();
  first_is_done.get_future().wait();
  item = "third";
  stage.Push(item);
  EXPECT_EQ(item, first);
  go_on.set_value();
  stage.Finish();
}

TEST(Stage, TellsTheCallerWhatWentWrong) {
  const auto fail = [](int&) { throw std::runtime_error("full disk"); };
  {
    Stage<int> stage(2, fail);
    int item = 0;
    stage.Push(item);
    EXPECT_THROW(stage.Finish(), std::runtime_error);
  }
  Stage<int> stage(2, fail);
  EXPECT_THROW(
      {
        for (int i = 0; i < 10; ++i) {
          int item = i;
          stage.Push(item);
        }
      },
      std::runtime_error);
}

TEST(Stage, DropsWhatWaitsIfTheCallerGivesUp) {
  int count = 0;
  {
    Stage<int> stage(20, [&](int&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      ++count;
    });
    for (int i = 0; i < 20; ++i) {
      int item = i;
      stage.Push(item);
    }
  }
  EXPECT_LT(count, 20);
}

}  // namespace
}  // namespace mjdiag
