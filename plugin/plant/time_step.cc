#include "mjdiag/plugin/plant/time_step.h"

#include <cmath>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {

void CheckTimeStep(const Setup& setup, const mjModel& model) {
  const double step = setup.rates.step();
  if (std::abs(model.opt.timestep / step - 1.0) > 1e-9) {
    throw InputError(setup.plant.string(),
                     "time step " + std::to_string(model.opt.timestep * 1e6) + " us",
                     std::to_string(step * 1e6) +
                         " us, the control tick of the setup over its substeps");
  }
}

}  // namespace mjdiag
