#pragma once
// What the machine of the setup does along a measured record, for the checks of the
// record.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// The nominal plant on the reference or under the inputs of the record, without noise.
/// Nothing is quantised or limited: a record in wrong units asks for far too much, and
/// limits would hide by how much.
/// @param from_readings  starts at the first readings; else at rest, for readings in
///                       wrong units would start far away
/// NumericalError if it diverges.
Record NominalRun(const Machine& machine, const Record& measured, bool from_readings);

/// The input of an actuator as the controllers of the setup command it for the recorded
/// reference and readings, whatever the plant does.
Eigen::VectorXd CommandedInput(const Setup& setup, const Record& measured,
                               const std::string& actuator);

/// The samples of a channel that figures count: without setup.compare.skip_samples.
Eigen::VectorXd CountedSamples(const Setup& setup, const Record& record,
                               const std::string& channel);

/// The same record with one channel times a number.
Record WithScaled(const Record& record, const std::string& channel, double factor);

}  // namespace mjdiag
