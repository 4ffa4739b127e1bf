#pragma once
// Questions that names leave open and the balance of forces may answer: each has options,
// and each option is another reading of the log.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/draft/log_physics.h"

namespace mjdiag {

struct OpenChoice {
  struct Option {
    std::string label;  ///< "deg"
    std::function<void(LogReading&)> apply;
    bool possible = true;  ///< not ruled out beforehand
  };
  std::string what;  ///< "'theta', 'alpha'"
  std::vector<Option> options;

  std::optional<std::size_t> chosen{};
  std::string because{};  ///< for people; empty of what is not decided
};

/// Decides what can be: an option that is the only possible one, or behind which the forces
/// balance clearly better than behind every other, whatever the other choices are.
void DecideByForces(const LogPhysics& physics, const LogReading& known,
                    std::vector<OpenChoice>& choices);

}  // namespace mjdiag
