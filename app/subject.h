#pragma once
// The options that say which machine a command works on and what is wrong with it.

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/scratch_folder.h"

namespace mjdiag::app {

/// What the user asked for, as text.
struct MachineOptions {
  std::string setup;
  std::string plant;  ///< in the place of the setup, for commands that draft one
  std::vector<std::string> overrides;
  std::vector<std::string> faults;
  std::vector<std::string> effects;
  bool no_friction = false;
  std::shared_ptr<ScratchFolder> drafted{};  ///< where the setup is, then
};

/// What moves it, and how.
struct MotionOptions {
  std::string trajectory;
  std::string replay;
  double duration = 0.0;
  std::string mode = "both";
  double noise_scale = 1.0;
  std::uint64_t seed = 1;
  bool linear = false;
};

/// The machine of the setup, and what is to be run.
struct Subject {
  Machine nominal;
  Machine machine;     ///< with the faults and effects of the options
  RunOptions options;  ///< with their disturbances and late faults

  const Setup& setup() const { return nominal.setup(); }
  bool healthy() const {
    return machine.changes() == Changes{} && options.disturbances.empty() &&
           options.late_faults.empty();
  }
};

/// What one should know about the machine of a setup: which actuators of its plant are 0
/// because the setup names none of their inputs.
std::vector<std::string> NotesOn(const Machine& machine);

/// Accepts finite numbers in least .. most only; CLI11's own ranges let NaN pass.
CLI::Validator Within(double least, double most);

void AddMachineOptions(CLI::App& command, MachineOptions& options);
/// The same with `--plant` in the place of `--setup`.
void AddMachineOrPlantOptions(CLI::App& command, MachineOptions& options);
/// Where `--plant` is given: drafts a setup from it and the record, which lasts as long as
/// the options, and points `setup` to it. InputError if something could not be told.
/// @param record  a file; empty: all joints and actuators
/// @return what was assumed, notes for people
std::vector<std::string> DraftMachine(MachineOptions& options,
                                      const std::string& record);
/// Where the clock of a record is even and a little off the control tick of the setup, its
/// samples are ticks: what is resampled is smeared. Sets the rate that goes with them.
/// @return notes for people
std::vector<std::string> AdoptClock(MachineOptions& options, const std::string& record);
void AddMotionOptions(CLI::App& command, MotionOptions& options);
/// `--seed`, a whole number from 0 on; CLI11 itself would take -1 for 2^64 - 1.
void AddSeedOption(CLI::App& command, std::uint64_t& seed, const std::string& words);

/// For commands that write a setup from the one that is given. InputError where options
/// change that. @param written  what they would not be in, "the calibrated setup"
void RequireUnchanged(const MachineOptions& options, const std::string& written);

/// InputError on a fault or effect that the machine does not have.
Subject LoadSubject(const MachineOptions& options);

/// A record that a command was given; what one should know about it comes behind the
/// notes, with the name of the file.
Record ReadMeasured(const Setup& setup, const std::string& file,
                    std::vector<std::string>& notes);

/// The trajectory (cut to the duration) or the replayed record.
Excitation MakeExcitation(const Setup& setup, const MotionOptions& motion,
                          std::vector<std::string>& notes);
/// Mode, noise and seed into the run's options.
void SetMotion(const MotionOptions& motion, RunOptions& options);
/// A run as the options want it, with a progress bar named `label`.
Record Run(const Machine& machine, const MotionOptions& motion,
           const Excitation& excitation, const RunOptions& options,
           const std::string& label);

/// Folder names of the faults and effects, for titles: "zeta_x = 1.2, ..."; "healthy".
std::string SubjectText(const Subject& subject);
/// The same for machines to read.
nlohmann::json ToJson(const Subject& subject);

}  // namespace mjdiag::app
