#include "support/hidden_cases/bonder_motion.h"

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace mjdiag::test {
namespace {

constexpr double kSlot = 0.036;  // s; the longest move takes 30 ms

struct Range {
  double move;  // to either side [m or rad]
  double tone;  // amplitude [m or rad]
  double slow;  // [Hz]
};
const std::map<std::string, Range> kRanges = {
    {"x", {4e-3, 1.5e-3, 2.3}}, {"y", {3e-3, 1.0e-3, 3.1}}, {"z", {0.04, 0.012, 4.7}}};

/// Which axes move in a slot: each alone, pairs, all, and none.
const std::vector<std::vector<std::string>> kTurns = {
    {"x"}, {"y"}, {"z"}, {"x", "y"}, {}, {"y", "z"}, {"x", "z"}, {"x", "y", "z"}};

}  // namespace

Trajectory BonderMotion(const Setup& setup, double duration, CaseDice dice) {
  Trajectory motion;
  motion.name = "own";
  motion.duration = duration;
  motion.ramp = 0.05;
  for (const AxisSetup& axis : setup.control.axes)
    motion.limits[axis.name] = axis.limits;
  std::map<std::string, double> place;
  std::size_t turn = 0;
  for (double at = 0.01; at + kSlot < duration; at += kSlot) {
    Move move{at, {}};
    for (const std::string& axis : kTurns[turn++ % kTurns.size()]) {
      // To the other side, at least a third of the way.
      const double side = place[axis] > 0.0 ? -1.0 : 1.0;
      const double to = side * kRanges.at(axis).move * dice.Even(0.33, 1.0);
      move.by[axis] = to - place[axis];
      place[axis] = to;
    }
    if (!move.by.empty()) motion.moves.push_back(move);
  }
  for (const auto& [axis, range] : kRanges) {
    const double phase = dice.Even(0.0, 2.0 * std::numbers::pi);
    const double pace = dice.Even(0.8, 1.2);
    motion.tones.push_back({axis, pace * range.slow, range.tone, phase});
    motion.tones.push_back({axis, pace * 9.0 * range.slow, 0.1 * range.tone, 0.0});
  }
  return motion;
}

}  // namespace mjdiag::test
