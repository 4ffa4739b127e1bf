#include "mjdiag/plugin/extension/setup_following.h"

#include "mjdiag/plugin/extension/setup_text.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

std::string MoveText(const Move& move) {
  std::string by;
  for (const auto& [axis, distance] : move.by) {
    by += (by.empty() ? "" : ", ") + axis + " = " + AllDigits(distance);
  }
  return "  { at = " + AllDigits(move.at) + ", by = { " + by + " } },\n";
}

std::string ToneText(const ReferenceTone& tone) {
  return "  { axis = \"" + tone.axis + "\", frequency = " + AllDigits(tone.frequency) +
         ", amplitude = " + AllDigits(tone.amplitude) +
         ", phase = " + AllDigits(tone.phase) + " },\n";
}

std::string LimitsText(const std::string& axis, const MoveLimits& limits) {
  return axis + " = { velocity = " + AllDigits(limits.velocity) +
         ", acceleration = " + AllDigits(limits.acceleration) +
         ", jerk = " + AllDigits(limits.jerk) + ", snap = " + AllDigits(limits.snap) +
         " }\n";
}

std::string TrajectoryText(const Trajectory& trajectory) {
  const std::string name = "[trajectories." + trajectory.name;
  std::string text =
      "\n" + name + "]\nduration = " + AllDigits(trajectory.duration) + "\n";
  if (!trajectory.moves.empty()) {
    text += "period = " + AllDigits(trajectory.period) + "\nmoves = [\n";
    for (const Move& move : trajectory.moves) text += MoveText(move);
    text += "]\n";
  }
  if (!trajectory.tones.empty()) {
    text += "ramp = " + AllDigits(trajectory.ramp) + "\ntones = [\n";
    for (const ReferenceTone& tone : trajectory.tones) text += ToneText(tone);
    text += "]\n";
  }
  if (trajectory.moves.empty() || trajectory.limits.empty()) return text;
  text += name + ".limits]\n";
  for (const auto& [axis, limits] : trajectory.limits) text += LimitsText(axis, limits);
  return text;
}

}  // namespace

std::string SetupFollowing(const std::filesystem::path& setup_file,
                           const Trajectory& trajectory) {
  const std::filesystem::path file = FindSetupFile(setup_file);
  SetupText text(file);
  if (text.At("trajectories." + trajectory.name)) {
    throw InputError(file.string(),
                     "has a trajectory '" + trajectory.name + "' already",
                     "another name");
  }
  text.SetBeside("plant", "default_trajectory", '"' + trajectory.name + '"');
  return text.Text() + TrajectoryText(trajectory);
}

}  // namespace mjdiag
