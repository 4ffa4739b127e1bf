#include "mjdiag/plugin/plant/time_step.h"

#include <cmath>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

/// Of the step of the model less that of the setup, a share.
double OffBy(const Setup& setup, const mjModel& model) {
  return std::abs(model.opt.timestep / setup.rates.step() - 1.0);
}

}  // namespace

void AdoptTimeStep(const Setup& setup, mjModel& model) {
  if (OffBy(setup, model) <= kNearStep) {
    model.opt.timestep = setup.rates.step();
  } else {
    CheckTimeStep(setup, model);
  }
}

void CheckTimeStep(const Setup& setup, const mjModel& model) {
  const double step = setup.rates.step();
  if (OffBy(setup, model) > 1e-9) {
    throw InputError(setup.plant.string(),
                     "time step " + std::to_string(model.opt.timestep * 1e6) + " us",
                     std::to_string(step * 1e6) +
                         " us, the control tick of the setup over its substeps");
  }
}

}  // namespace mjdiag
