#pragma once
// The linear model of a machine, with the tick of its controllers.

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag::python {

struct LinearObject {
  MechanicalModel model;
  Rates rates;
};

}  // namespace mjdiag::python
