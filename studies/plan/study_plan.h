#pragma once
// A study of one's own, as its plan says it: which machine, what varies in its runs, how
// often, and what is kept of each. docs/datasets.md describes every key of the file.
//
// A plan is a list of runs, numbered from 0, and each is a function of the plan and its
// number alone (planned_run.h): whoever makes it, in whatever order, on however many
// cores or computers, makes the same.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/controllers/axis_controller.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/studies/plan/plan_ask.h"

namespace mjdiag {

/// What an axis of variation moves.
enum class AxisKind {
  kFault,        ///< a fault parameter of the plant
  kDisturbance,  ///< the magnitude of a disturbance of the setup
  kEffect,       ///< a parameter of an effect that the plant lacks
  kKey,          ///< a number of the setup
  kNoise         ///< a factor of the noise of all sensors
};

/// From the one that is nearer to healthy, as a rule, to the other.
struct ValueRange {
  double from = 0.0;
  double to = 0.0;

  bool operator==(const ValueRange&) const = default;
};

/// [[axis]]: something that varies.
struct PlanAxis {
  AxisKind kind = AxisKind::kFault;
  /// "zeta_x", "coulomb_friction@X:force", "sensors.x.noise_sd", "noise".
  std::string name;
  std::string unit;                ///< SI; "1" of a factor
  double healthy = 1.0;            ///< the value at which nothing is wrong
  std::vector<double> values;      ///< to choose from; empty: ranges
  std::vector<ValueRange> ranges;  ///< one is chosen, then a value in it
  /// Evenly in the logarithm of the deviation from healthy.
  bool logarithmic = false;
  int points = 0;  ///< of a grid, in every range
  /// When it appears [s]; none: it is there from the start. Fault parameters and
  /// disturbances.
  std::optional<ValueRange> appears;
  double growth = 0.0;    ///< time in which a fault parameter becomes that [s]
  std::string effect;     ///< effect and site, "coulomb_friction@X"
  std::string parameter;  ///< of the effect
};

/// How values are chosen.
enum class PlanMethod {
  kGrid,        ///< every value with every other
  kOneAtATime,  ///< every value of an axis, with all others healthy, axis by axis
  kRandom,      ///< independent draws
  kSobol        ///< a low-discrepancy sequence, which fills the axes evenly
};

/// [[case]]: runs of one kind, for example those with one fault.
struct PlanCase {
  std::string name;
  std::vector<PlanAxis> axes;  ///< those of the plan, then its own
  PlanMethod method = PlanMethod::kGrid;
  int points = 1;  ///< combinations of values, on every machine
  /// Of its own axes only so many vary in a run, others are healthy; none: all.
  std::optional<std::array<int, 2>> choose{};
  std::size_t common = 0;  ///< axes of the plan, which always vary

  /// Coordinates of a point.
  int dimensions() const;
};

/// Which part of a data set a machine is for.
enum class Split { kTrain, kValidation, kTest };
std::string SplitName(Split split);

/// [machines]: machines of that type, each of which is what it is in all of its runs.
struct PlanMachines {
  int count = 1;
  /// What differs between them, with the standard deviation of its logarithm.
  std::vector<std::pair<ModelParameter, double>> numbers;
  std::array<double, 3> shares = {1.0, 0.0, 0.0};  ///< of train, validation and test
};

/// [keep]: what is kept of every run.
struct PlanKeep {
  std::vector<std::string> channels;  ///< of the record
  std::vector<std::string> joints;    ///< of it, without "joint."
  int every = 1;                      ///< one sample of so many
  bool single_precision = false;
  bool residual = false;
  bool estimates = false;
  bool verdicts = false;
  std::vector<std::string> features;  ///< of these channels (features.h)
  int segment = 2048;                 ///< of their spectra [samples]

  bool Diagnoses() const { return residual || estimates || verdicts; }
  bool Series() const { return residual || !channels.empty() || !joints.empty(); }
};

/// What moves the machine in a run.
struct PlanMotion {
  std::string name;              ///< of the trajectory; of a record, its file
  std::filesystem::path record;  ///< whose motion or inputs are replayed; empty: none
};

struct StudyPlan {
  std::string text;  ///< of the file
  std::string name;
  std::filesystem::path setup;
  std::vector<std::string> overrides;  ///< of the setup, in all runs
  bool linear = false;
  ControlMode mode = ControlMode::kBoth;
  std::vector<PlanMotion> motions;
  double duration = 0.0;  ///< of a run [s]; 0: as its motion says
  int replications = 1;   ///< of every point, with noise of their own
  std::uint64_t seed = 1;
  PlanMachines machines;
  std::vector<PlanCase> cases;
  PlanKeep keep;
  std::optional<PlanAsk> ask{};  ///< none: a data set

  /// Asks for so many: of points where these are drawn, else of replications.
  void SetRuns(int runs);
  std::int64_t RunsOfAMachine() const;
  std::int64_t Runs() const { return machines.count * RunsOfAMachine(); }
};

/// A plan with the machine that its setup describes.
struct LoadedPlan {
  StudyPlan plan;
  Machine machine;
};

/// InputError says file, line and key, what is wrong there and what was expected:
/// malformed TOML, unknown or missing keys, wrong types, values out of range, and names
/// that neither setup nor plant has.
LoadedPlan ReadPlan(const std::filesystem::path& file);
/// Of a text. @param folder  that its setup is relative to
LoadedPlan ParsePlan(const std::string& text, const std::filesystem::path& folder,
                     const std::string& where = "plan");

/// Of a text, for this machine in the place of the one that it names. InputError also if
/// the plan varies keys of the setup.
LoadedPlan ParsePlanFor(const Machine& machine, const std::string& text,
                        const std::string& where);

/// The most runs that a plan may have.
inline constexpr std::int64_t kMostRuns = 10'000'000;

}  // namespace mjdiag
