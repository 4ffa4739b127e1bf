#pragma once
// A machine as Python has it: where it comes from, the machine as it was given, what was
// put into it since, and what a run of it has besides.

#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/design/calibrate.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/measured_columns.h"
#include "python/long_call.h"
#include "python/machine_source.h"

namespace mjdiag::python {

/// Filters and limits take seconds to make and are the same every time.
class PreparedCache {
 public:
  /// Of the machine taken as linear or not; made when first asked for.
  std::shared_ptr<const PreparedDiagnosis> For(const Machine& machine, bool linear,
                                               LongCall& call);
  void Keep(PreparedDiagnosis prepared);
  /// The first of those that are made; null if none is.
  std::shared_ptr<const PreparedDiagnosis> Kept() const;

 private:
  mutable std::mutex mutex_;
  std::map<bool, std::shared_ptr<const PreparedDiagnosis>> made_;
};

class MachineObject {
 public:
  MachineObject(MachineSource source, Machine machine)
      : source_(std::move(source)),
        original_(machine),
        nominal_(machine),
        machine_(std::move(machine)) {}

  const MachineSource& source() const { return source_; }
  const Machine& machine() const { return machine_; }
  const Setup& setup() const { return machine_.setup(); }
  /// Magnitudes of disturbances in its runs.
  const std::map<std::string, double>& disturbances() const { return disturbances_; }
  PreparedCache& prepared() const { return *prepared_; }
  /// What a calibration said; none without one.
  const std::optional<CalibrationReport>& calibration() const { return calibration_; }

  /// Faults and disturbances by name; those that it has already get the new value.
  MachineObject WithFaults(const std::map<std::string, double>& values) const;
  MachineObject WithEffect(const PlacedEffect& effect) const;
  MachineObject WithCalibration(const CalibrationReport& report,
                                const Machine& calibrated,
                                PreparedDiagnosis prepared) const;
  /// The machine with that in it, as if it had been given so.
  MachineObject Extended(const Changes& changes, int substeps) const;

  /// The machine with one more trajectory, which is its default one.
  MachineObject Following(const Trajectory& trajectory) const;

  /// Makes a folder of it, which is a setup: with all that was put into the plant, or with
  /// what a calibration said. @return plant.xml or, of the latter, setup.toml
  std::filesystem::path Write(const std::filesystem::path& folder) const;

  /// Makes a folder with its setup, and that trajectory as the default one.
  /// @return setup.toml. InputError if it is not as its files have it
  std::filesystem::path WriteFollowing(const std::filesystem::path& folder,
                                       const Trajectory& trajectory) const;

  /// What it is asked of has to be a machine that runs by itself. InputError beginning
  /// with `what` if it has disturbances.
  void RequireQuiet(const std::string& what) const;

 private:
  using Folders = std::vector<std::unique_ptr<ScratchFolder>>;

  MachineObject Changed(Changes changes) const;
  /// Its setup, with the trajectories that it was made to follow, for another folder.
  /// @param made  holds what is written for that
  std::filesystem::path SetupFor(const std::filesystem::path& folder,
                                 Folders& made) const;

  MachineSource source_;
  Machine original_;  // as its files have it
  Machine nominal_;   // what faults and effects are put into
  Machine machine_;   // with them
  Changes changes_;   // from nominal to machine
  std::map<std::string, double> disturbances_;
  std::vector<Trajectory> followed_;  // besides those of its files
  std::shared_ptr<PreparedCache> prepared_ = std::make_shared<PreparedCache>();
  std::optional<CalibrationReport> calibration_;
};

/// A Record, or the path of a measured file, as a record of that machine: what of it was
/// not measured is marked. InputError beginning with `what`.
MeasuredFile MeasuredOf(const Setup& setup, pybind11::handle record,
                        const std::string& what);
/// One of those, or a sequence of them.
std::vector<MeasuredFile> AllMeasured(const Setup& setup,
                                      const pybind11::object& records,
                                      const std::string& what);

}  // namespace mjdiag::python
