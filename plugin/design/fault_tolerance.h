#pragma once
// Fault-tolerant control of a machine: what a diagnosis finds while the machine runs
// acts on its controllers ([AB383], Fig. 25).
//
//   const TolerancePlan plan = PlanTolerance(machine);
//   const TolerantRun run = RunTolerantly(machine, prepared, plan, motion.samples(), {},
//       [&](const RunOptions& options) { return Simulate(worn, motion, options); });
//   run.faults;  // what was corrected (tolerant_run.h)
//
// What is done about which fault follows from the plant: a motor whose fault parameter
// scales its gear is driven harder, inside the gain margins of the machine
// (gain_margins.h); what dampers and springs ask for along the reference is the change
// of the machine's inverse (reference_forces.h); tones are those of the setup. What is
// certain, how changes come and how they go is said in
// mjdiag/controllers/reconfiguration.h. Times follow from the slowest mode of the loop,
// with its time constant T:
//
// - a fault has to be certain for 2 T: what passes sooner is nothing to act on,
// - what acts follows with 3 T, slowly against the loop, which so has no transient,
// - an estimate that becomes uncertain, as when a twin begins anew, is given 10 T.

#include <string>
#include <vector>

#include "mjdiag/controllers/reconfiguration.h"
#include "mjdiag/diagnosis/monitor.h"
#include "mjdiag/plugin/design/gain_margins.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

/// Everything that the reconfiguration of a machine is made of, found once a machine.
struct TolerancePlan {
  GainMargins margins;
  std::vector<RemediedAxis> axes;
  std::vector<FaultRemedy> remedies;  ///< fault parameters, then disturbances
  ReconfigurationOptions options;
};

/// @param machine  the healthy one
/// @param mode     which part of the controllers acts: forces along the reference belong
///                 to the feedforward
/// InputError if it has no controllers or nothing that may wear.
TolerancePlan PlanTolerance(const Machine& machine,
                            ControlMode mode = ControlMode::kBoth);

/// What was done about a fault, for people.
struct Tolerated {
  std::string fault;
  std::string action;   ///< "drive gain of x", "feedforward", "tones cancelled"
  double value = 0.0;   ///< of the fault that is acted on at the end
  double since = 0.0;   ///< [s]
  bool acting = false;  ///< or it has been let go
  double until = 0.0;   ///< [s], if so
};

/// What a monitor with a twin knows, at a tick at which its standard deviations are those
/// of its estimate: it finds them now and then. Without a twin no estimate is certain.
/// Does not allocate.
void ReadEstimates(const DiagnosisMonitor& monitor, FaultEstimates& estimates) noexcept;

class FaultTolerance final : public TickObserver {
 public:
  /// @param monitor   follows a twin of the healthy machine; not owned
  /// @param diagnosis feeds it; not owned
  /// InputError if its faults are not those of the plan, or it has no twin.
  FaultTolerance(const TolerancePlan& plan, const DiagnosisMonitor& monitor,
                 TickObserver& diagnosis);

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override;

  Reconfiguration& reconfiguration() { return reconfiguration_; }
  const Reconfiguration& reconfiguration() const { return reconfiguration_; }

 private:
  const DiagnosisMonitor& monitor_;
  TickObserver& diagnosis_;
  Reconfiguration reconfiguration_;
  FaultEstimates estimates_;
  Eigen::VectorXd known_sd_;  // of the monitor, when they were read
};

/// Faults that have been acted on, in the order of the remedies.
std::vector<Tolerated> Summarise(const Reconfiguration& reconfiguration,
                                 const Setup& setup);

}  // namespace mjdiag
