#pragma once
// mjdiag excite: what its two kinds of machines share.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/output.h"
#include "app/subject.h"
#include "mjdiag/studies/excitation/motion_design.h"

namespace mjdiag::app {

struct ExciteCommand {
  MachineOptions machine;
  OutputOptions output;
  std::string record;
  std::vector<std::string> limits;  ///< as they were typed
  std::optional<double> budget;     ///< of work [s]
  MotionDesignOptions design;
};

inline constexpr const char* kStoppedText =
    "ended before everything was tried: by a signal, or by --budget\n";

/// Whether the work's time is over, if there is a budget, or an end is wished.
std::function<bool()> StopOf(std::optional<double> budget);

/// Of a machine without controllers, beside a measured motion.
void ExciteJoints(const Machine& machine, const ExciteCommand& command);

}  // namespace mjdiag::app
