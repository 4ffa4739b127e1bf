#pragma once
// What the parts of an answer are about: a machine, what was measured of it, and the blocks
// of which a model of what it lacks is made.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/answer/split_run.h"
#include "mjdiag/discovery/fit/model.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/machine/physics_steps.h"

namespace mjdiag {

struct AnswerData {
  const Machine& machine;  ///< as given
  const SplitRun& run;
  const Eigen::VectorXd& reading_sd;  ///< of every sensor, by itself
  const std::vector<Block>& blocks;
  PhysicsSteps steps = {};  ///< Explained::steps

  Machine With(const Model& model) const {
    return steps.Of(machine.With(ChangesOfModel(blocks, model)));
  }
};

}  // namespace mjdiag
