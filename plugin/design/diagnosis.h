#pragma once
// A whole diagnosis of a machine, from its setup to a verdict. Three steps:
//
//   const Machine machine(ReadSetup("mjcf/ab383"));
//   const PreparedDiagnosis prepared = PrepareDiagnosis(machine);
//   const Diagnosis diagnosis = Diagnose(machine, prepared, record);
//   std::cout << DiagnosisVerdict(diagnosis.result) << "\n";
//
// 1. Prepare: residual generators and prefilters from the linearised plant
//    (filter_design.h), or for a machine with friction from its nominal runs, too
//    (robust_design.h), or read from a file; and limits from healthy runs. Once a
//    machine, or once a motion if a baseline is wanted.
// 2. Watch: a monitor (mjdiag/diagnosis/monitor.h) sees every control tick of a record
//    (Diagnose) or of a run of the simulated machine (DiagnoseRun). The bits are the
//    same.
// 3. Conclude: which limits were left and when, which fault is how large, which tones
//    are there. DiagnosisVerdict says it in a sentence (diagnosis_verdict.h), and
//    DiagnosisJson for other programs (diagnosis_json.h).
//
// Times are in seconds since the first sample, faults are values of fault parameters
// (1: healthy), disturbances of their magnitude gamma (0: healthy).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

/// Where filters and limits come from.
struct DiagnosisSource {
  std::filesystem::path filters;  ///< filters.json; empty: designed on the spot
  /// Fault for which the residual is the one that nominal runs of the nonlinear plant
  /// excite least; empty: one residual for all faults. Needs the motion.
  std::string robust;
  /// Subtract the residual that the healthy plant leaves on this very motion. Needs the
  /// motion.
  bool baseline = false;
  NominalRuns nominal;  ///< the healthy runs: on which plant, how many
};

/// Beside the setup of a calibrated machine: its filters, with limits that hold for the
/// runs that it was calibrated on.
inline constexpr const char* kCalibratedFilters = "filters.json";

/// Whether that source asks for the motion that is going to be diagnosed.
bool NeedsMotion(const DiagnosisSource& source);

/// Filters with limits, ready to watch a machine.
struct PreparedDiagnosis {
  DiagnosisDesign design;
  Eigen::MatrixXd baseline;  ///< subtracted from the residuals, n x samples, or empty
  Excitation motion;         ///< to which the baseline belongs, if there is one
  NominalRuns nominal;       ///< as healthy runs of that motion are made
};

/// @param motion  where NeedsMotion(source), else left out; Replay makes it of a record
/// InputError if the file of filters belongs to other channels or another control tick
/// than the setup, or the setup cannot be diagnosed (DesignFilters).
PreparedDiagnosis PrepareDiagnosis(const Machine& machine,
                                   const DiagnosisSource& source = {},
                                   const Excitation& motion = {});

/// InputError that begins with `what` if filters were made for other channels or
/// another control tick than those of the setup.
void RequireSameMachine(const std::string& what, const DiagnosisDesign& design,
                        const Setup& setup);

/// A diagnosis before its first tick: the monitor with its twin, and a recorder with
/// room for that many ticks.
DiagnosisRecording BeginDiagnosis(const Machine& machine,
                                  const PreparedDiagnosis& prepared,
                                  Eigen::Index capacity);

/// The answer, and the run that it was drawn from as pages show it.
struct Diagnosis {
  DiagnosisResult result;
  MonitorLog log;
};

/// The diagnosis of a measured or simulated record, over the horizon that the setup
/// gives. InputError if a channel is missing, the record has another rate than the
/// filters or is shorter than the horizon, or (without a twin) the motion does not tell
/// the faults apart.
Diagnosis Diagnose(const Machine& machine, const PreparedDiagnosis& prepared,
                   const Record& record);

/// What a recording says at the end of its run.
Diagnosis ConcludeWithLog(const DiagnosisRecording& recording);

struct DiagnosedRun {
  Record record;
  Diagnosis diagnosis;
};

/// A run of the simulated machine with the diagnosis inside its control callback; on
/// the linear plant where `prepared` has its healthy runs from there.
/// @param machine  the healthy one, which `prepared` is made for
/// @param faults   what is wrong with the one that runs
/// @param options  disturbances, noise and seed of the run; its observer is replaced
DiagnosedRun DiagnoseRun(const Machine& machine, const PreparedDiagnosis& prepared,
                         const Excitation& motion, const Changes& faults = {},
                         RunOptions options = {});

}  // namespace mjdiag
