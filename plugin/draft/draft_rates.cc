#include "mjdiag/plugin/draft/draft_rates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

constexpr double kSameRate = 0.02;  // clocks of computers jitter by that
constexpr double kMostSubsteps = 1000.0;

/// To so many significant digits.
double Rounded(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return ParseNumber(text.data()).value_or(value);
}

/// 499.9 Hz is 500 Hz to a percent, and no other number of one digit.
double NiceRate(double rate) {
  for (int digits = 1; digits <= 3; ++digits) {
    const double nice = Rounded(rate, digits);
    if (std::abs(nice / rate - 1.0) < 0.005) return nice;
  }
  return Rounded(rate, 4);
}

}  // namespace

void DraftRates(const mjModel& model, double interval, SetupDraft& draft) {
  const double step = model.opt.timestep;
  if (model.opt.integrator != mjINT_EULER && model.opt.integrator != mjINT_IMPLICIT) {
    draft.additions.euler = true;
    draft.added.push_back(
        "integrator=\"Euler\": the linear plant, which discover needs, is stepped so");
  }
  if (!(interval > 0.0)) {
    draft.control = Rounded(1.0 / step, 12);
    draft.substeps = 1;
    return;
  }
  const double steps = std::round(interval / step);
  if (steps >= 1.0 && steps <= kMostSubsteps &&
      std::abs(steps * step / interval - 1.0) <= kSameRate) {
    draft.substeps = static_cast<int>(steps);
    draft.control = Rounded(1.0 / (steps * step), 12);
    draft.assumed.push_back("the rate of the log is " +
                            FormatQuantity(draft.control, "Hz"));
    return;
  }
  draft.control = NiceRate(1.0 / interval);
  const double tick = 1.0 / draft.control;
  draft.substeps =
      static_cast<int>(std::clamp(std::ceil(tick / step - 1e-6), 1.0, kMostSubsteps));
  draft.additions.timestep = tick / draft.substeps;
  draft.assumed.push_back("the rate of the log is " +
                          FormatQuantity(draft.control, "Hz"));
  draft.added.push_back("timestep " + FormatQuantity(*draft.additions.timestep, "s") +
                        " in the place of " + FormatQuantity(step, "s") +
                        ", which is no whole part of the time between rows");
}

}  // namespace mjdiag
