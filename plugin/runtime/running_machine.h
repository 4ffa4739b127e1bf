#pragma once
// A machine at work, tick by tick, for as long as one likes: the nonlinear plant with the
// controllers in MuJoCo's control callback, or the linear plant on the exact map of a
// control tick. It may become another machine while it runs.

#include <Eigen/Core>
#include <memory>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class RunningMachine {
 public:
  virtual ~RunningMachine() = default;

  /// One control tick. NumericalError says at which time and joint it diverged.
  virtual void Tick() = 0;
  /// From the next tick on it is that machine, which differs in fault parameters only;
  /// with `ticks` it becomes it in so many of them, evenly.
  virtual void Become(const Machine& machine, Eigen::Index ticks = 0) = 0;
  /// What is logged of it so far.
  virtual Record ToRecord() const = 0;
};

/// At rest. `options.late_faults` of the plant and `options.progress` are left to the
/// caller. InputError if the excitation is empty, or as TickLoop.
std::unique_ptr<RunningMachine> StartNonlinear(const Machine& machine,
                                               const Excitation& excitation,
                                               const RunOptions& options);
/// InputError as SimulateLinear, too.
std::unique_ptr<RunningMachine> StartLinear(const Machine& machine,
                                            const Excitation& excitation,
                                            const RunOptions& options);

}  // namespace mjdiag
