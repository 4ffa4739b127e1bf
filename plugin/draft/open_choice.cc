#include "mjdiag/plugin/draft/open_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjdiag {
namespace {

constexpr std::size_t kMostReadings = 64;
constexpr double kMargin = 0.8;  // of the next best

std::string Percent(double share) {
  return std::to_string(static_cast<int>(std::lround(100.0 * share))) + " %";
}

void TakeTheOnlyPossible(OpenChoice& choice) {
  std::optional<std::size_t> only;
  for (std::size_t i = 0; i < choice.options.size(); ++i) {
    if (!choice.options[i].possible) continue;
    if (only) return;
    only = i;
  }
  choice.chosen = only;
}

/// Least imbalance behind every option of every choice, over those of the others.
using Least = std::vector<std::vector<double>>;

std::optional<Least> LeastImbalances(const LogPhysics& physics, const LogReading& known,
                                     const std::vector<OpenChoice>& choices) {
  Least least;
  std::size_t count = 1;
  for (const OpenChoice& choice : choices) {
    least.emplace_back(choice.options.size(), std::numeric_limits<double>::infinity());
    count *= choice.options.size();
    if (count > kMostReadings) return std::nullopt;
  }
  for (std::size_t number = 0; number < count; ++number) {
    LogReading reading = known;
    std::vector<std::size_t> picked;
    bool possible = true;
    std::size_t rest = number;
    for (const OpenChoice& choice : choices) {
      const std::size_t option = rest % choice.options.size();
      rest /= choice.options.size();
      picked.push_back(option);
      possible = possible && choice.options[option].possible;
    }
    if (!possible) continue;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      choices[i].options[picked[i]].apply(reading);
    }
    const std::optional<double> imbalance = physics.Imbalance(reading);
    if (!imbalance) return std::nullopt;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      least[i][picked[i]] = std::min(least[i][picked[i]], *imbalance);
    }
  }
  return least;
}

void Decide(const std::vector<double>& imbalances, OpenChoice& choice) {
  const auto best = std::ranges::min_element(imbalances);
  if (*best > kBalanced) return;
  double next = std::numeric_limits<double>::infinity();
  std::size_t second = 0;
  for (std::size_t i = 0; i < imbalances.size(); ++i) {
    if (i == static_cast<std::size_t>(best - imbalances.begin()) ||
        imbalances[i] >= next) {
      continue;
    }
    next = imbalances[i];
    second = i;
  }
  if (*best > kMargin * next) return;
  choice.chosen = static_cast<std::size_t>(best - imbalances.begin());
  choice.because = "forces balance to " + Percent(*best);
  if (std::isfinite(next)) {
    choice.because += ", with " + choice.options[second].label + " to " + Percent(next);
  }
}

}  // namespace

void DecideByForces(const LogPhysics& physics, const LogReading& known,
                    std::vector<OpenChoice>& choices) {
  for (OpenChoice& choice : choices) TakeTheOnlyPossible(choice);
  if (std::ranges::all_of(choices,
                          [](const OpenChoice& c) { return c.chosen.has_value(); }))
    return;
  const std::optional<Least> least = LeastImbalances(physics, known, choices);
  if (!least) return;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!choices[i].chosen) Decide((*least)[i], choices[i]);
  }
}

}  // namespace mjdiag
