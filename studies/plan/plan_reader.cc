// A plan from TOML. What is asked of the document here is all that it may have.

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/plugin/setup/toml_table.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/studies/plan/ask_reader.h"
#include "mjdiag/studies/plan/axis_reader.h"
#include "mjdiag/studies/plan/plan_check.h"
#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag {
namespace {

constexpr const char* kSchema = "mjdiag.plan/1";
constexpr int kMost = 1'000'000;
constexpr double kLongestRun = 1e4;  // [s]

constexpr NumberRule kDuration{[](double x) { return x > 0.0 && x <= kLongestRun; },
                               "seconds above 0, at most 10000"};

ControlMode ReadMode(const TomlTable& root) {
  const std::string mode = root.Text("mode", "both");
  if (mode == "feedback") return ControlMode::kFeedback;
  if (mode == "feedforward") return ControlMode::kFeedforward;
  if (mode != "both") {
    root.Fail("mode", "is '" + mode + "'", R"("both", "feedback" or "feedforward")");
  }
  return ControlMode::kBoth;
}

std::uint64_t ReadSeed(const TomlTable& root) {
  return static_cast<std::uint64_t>(
      root.Integer("seed", 0, std::numeric_limits<int>::max(), 1));
}

Machine ReadMachine(const TomlTable& root, const StudyPlan& plan,
                    const Machine* machine) {
  if (machine != nullptr) return *machine;
  try {
    return Machine(ReadSetup(plan.setup, plan.overrides));
  } catch (const InputError& error) {
    throw InputError(root.Where("setup") + ": " + error.what());
  }
}

std::vector<PlanMotion> ReadMotions(const TomlTable& root, const Setup& setup,
                                    const std::filesystem::path& folder) {
  std::vector<PlanMotion> motions;
  std::vector<std::string> known;
  for (const Trajectory& one : setup.trajectories.all) known.push_back(one.name);
  std::vector<std::string> fallback;
  if (!setup.trajectories.fallback.empty() && !root.Has("replay")) {
    fallback.push_back(setup.trajectories.fallback);
  }
  for (const std::string& name : root.Texts("trajectories", fallback)) {
    if (setup.control.axes.empty()) {
      root.Fail("trajectories", "'" + setup.name + "' has no controlled axes",
                "replay, records with its inputs");
    }
    RequireDeclared(root, "trajectories", name, "trajectory", known);
    motions.push_back({name, {}});
  }
  for (const std::string& file : root.Texts("replay", {})) {
    motions.push_back({file, folder / file});
  }
  if (motions.empty()) {
    root.Fail("nothing moves the machine",
              "trajectories of the setup, or replay, records with its inputs");
  }
  return motions;
}

double SpreadFor(const TomlTable& table, const mjModel& plant,
                 const ModelParameter& number, const std::optional<double>& given) {
  if (given) return *given;
  const std::string spread = table.Text("spread", "known");
  if (spread == "usual") return UsualSpread(number.kind);
  const double known = SpreadOf(plant, number);
  if (known > 0.0) return known;
  table.Fail("numbers",
             "the plant says that " + ModelParameterName(plant, number) + " is exact",
             R"(spread = "usual", or sd = a relative standard deviation)");
}

PlanMachines ReadMachines(const TomlTable& root, const Machine& machine) {
  PlanMachines machines;
  const std::optional<TomlTable> table = root.FindTable("machines");
  if (!table) return machines;
  machines.count = table->Integer("count", 1, kMost, 1);
  std::optional<double> sd;
  if (table->Has("sd")) sd = table->Number("sd", kPositive);
  const std::string spread = table->Text("spread", "known");
  if (spread != "known" && spread != "usual") {
    table->Fail("spread", "is '" + spread + "'", R"("known" or "usual")");
  }
  for (const std::string& text : table->Texts("numbers", {})) {
    WithPlace(*table, "numbers", [&] {
      for (const ModelParameter& number : ModelParametersOf(machine.plant(), text)) {
        machines.numbers.emplace_back(number,
                                      SpreadFor(*table, machine.plant(), number, sd));
      }
    });
  }
  if (const auto split = table->FindTable("split")) {
    constexpr NumberRule kPart{[](double x) { return x >= 0.0 && x <= 1.0; },
                               "a share from 0 to 1"};
    machines.shares = {split->Number("train", kPart, 0.0),
                       split->Number("validation", kPart, 0.0),
                       split->Number("test", kPart, 0.0)};
    const auto& [train, validation, test] = machines.shares;
    if (std::abs(train + validation + test - 1.0) > 1e-9) {
      split->Fail("does not add up to 1", "shares of train, validation and test");
    }
    const auto edge = [&](double share) { return std::lround(share * machines.count); };
    const std::array counts{edge(train), edge(train + validation) - edge(train),
                            machines.count - edge(train + validation)};
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (machines.shares[i] == 0.0 || counts[i] > 0) continue;
      split->Fail("leaves no machine for " + SplitName(static_cast<Split>(i)),
                  "more than count = " + std::to_string(machines.count));
    }
  }
  return machines;
}

/// Its points are the values of its axes, and no draws.
bool IsListed(PlanMethod method) {
  return method == PlanMethod::kGrid || method == PlanMethod::kOneAtATime;
}

PlanMethod ReadMethod(const TomlTable& table, PlanMethod fallback) {
  if (!table.Has("method")) return fallback;
  const std::string method = table.Text("method");
  if (method == "one at a time") return PlanMethod::kOneAtATime;
  if (method == "random") return PlanMethod::kRandom;
  if (method == "sobol") return PlanMethod::kSobol;
  if (method != "grid") {
    table.Fail("method", "is '" + method + "'",
               R"("grid", "one at a time", "random" or "sobol")");
  }
  return PlanMethod::kGrid;
}

std::vector<PlanAxis> ReadAxes(const TomlTable& table, const AxisSurroundings& around) {
  std::vector<PlanAxis> axes = ReadSizes(table, around.machine);
  for (const TomlTable& axis : table.TableArray("axis")) {
    for (PlanAxis& one : ReadAxis(axis, around)) {
      if (std::ranges::find(axes, one.name, &PlanAxis::name) != axes.end()) {
        axis.Fail("moves '" + one.name + "', as another axis does", "one of them");
      }
      axes.push_back(std::move(one));
    }
  }
  return axes;
}

/// How many points a case has, once its axes are there.
void ReadPoints(const TomlTable& table, const std::optional<int>& common,
                PlanCase& one) {
  if (IsListed(one.method)) {
    if (table.Has("points")) {
      table.Fail("points", "a grid has those of its axes", "points of an axis");
    }
    const bool alone = one.method == PlanMethod::kOneAtATime;
    std::int64_t points = alone ? 0 : 1;
    for (const PlanAxis& axis : one.axes) {
      const bool varying_time = axis.appears && axis.appears->from != axis.appears->to;
      if (varying_time) {
        table.Fail("axis " + axis.name + " appears at any of many times, on a grid",
                   "appears without appears_until, or another method");
      }
      const auto values = static_cast<std::int64_t>(
          axis.values.empty()
              ? axis.ranges.size() * static_cast<std::size_t>(axis.points)
              : axis.values.size());
      points = alone ? points + values : points * values;
      if (points > kMost) table.Fail("the grid has too many points", "a million");
    }
    one.points = static_cast<int>(points);
    return;
  }
  if (!table.Has("points") && common) {
    one.points = *common;
    return;
  }
  one.points = table.Integer("points", 1, kMost);
}

void ReadChoose(const TomlTable& table, PlanCase& one) {
  if (!table.Has("choose")) return;
  const std::vector<double> numbers = table.Numbers("choose", kNonNegative);
  const auto own = static_cast<double>(one.axes.size() - one.common);
  const bool whole = std::ranges::all_of(
      numbers, [](double number) { return number == std::floor(number); });
  if (numbers.size() != 2 || !whole || numbers[0] > numbers[1] || numbers[1] > own) {
    table.Fail("choose", "is no range of numbers of axes",
               "[least, most] of the " + std::to_string(static_cast<int>(own)) +
                   " axes of the case");
  }
  if (IsListed(one.method)) {
    table.Fail("choose", "on a grid", R"(method = "random" or "sobol")");
  }
  one.choose = {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
}

std::vector<PlanCase> ReadCases(const TomlTable& root, const AxisSurroundings& around) {
  const PlanMethod method = ReadMethod(root, PlanMethod::kGrid);
  const std::vector<PlanAxis> common = ReadAxes(root, around);
  std::vector<PlanCase> cases;
  std::optional<int> points;
  const std::vector<TomlTable> tables = root.TableArray("case");
  if (!IsListed(method) && !tables.empty() && root.Has("points")) {
    points = root.Integer("points", 1, kMost);
  }
  for (const TomlTable& table : tables) {
    PlanCase one{table.Text("name"), common, ReadMethod(table, method)};
    one.common = common.size();
    if (std::ranges::find(cases, one.name, &PlanCase::name) != cases.end()) {
      table.Fail("name", "'" + one.name + "' is another case, too",
                 "a name of its own");
    }
    for (PlanAxis& axis : ReadAxes(table, around)) {
      if (std::ranges::find(common, axis.name, &PlanAxis::name) != common.end()) {
        table.Fail("moves '" + axis.name + "', as an axis of all cases does",
                   "one of them");
      }
      one.axes.push_back(std::move(axis));
    }
    ReadPoints(table, points, one);
    ReadChoose(table, one);
    cases.push_back(std::move(one));
  }
  if (!cases.empty()) return cases;
  PlanCase all{"all", common, method};
  ReadPoints(root, std::nullopt, all);
  ReadChoose(root, all);
  return {all};
}

/// A key is one of the setup that the plan names.
void RefuseKeys(const TomlTable& root, const StudyPlan& plan) {
  for (const PlanCase& one : plan.cases) {
    for (const PlanAxis& axis : one.axes) {
      if (axis.kind != AxisKind::kKey) continue;
      root.Fail("varies " + axis.name + ", a key of its own setup",
                "other axes, in a plan for any machine");
    }
  }
}

StudyPlan ReadHead(const TomlTable& root, const std::filesystem::path& folder) {
  root.RequireSchema(kSchema);
  StudyPlan plan;
  plan.name = root.Text("name");
  plan.setup = folder / root.Text("setup");
  plan.overrides = root.Overrides("set");
  plan.linear = root.Flag("linear", false);
  plan.mode = ReadMode(root);
  plan.duration = root.Has("duration") ? root.Number("duration", kDuration) : 0.0;
  plan.replications = root.Integer("replications", 1, kMost, 1);
  plan.seed = ReadSeed(root);
  return plan;
}

/// @param given  in the place of the machine that the plan names; none: that one
LoadedPlan Read(const TomlDocument& document, const std::string& text,
                const std::filesystem::path& folder, const Machine* given) {
  const TomlTable root = document.Root();
  StudyPlan plan = ReadHead(root, folder);
  plan.text = text;
  Machine machine = ReadMachine(root, plan, given);
  if (given != nullptr) plan.setup = given->setup().folder;
  plan.motions = ReadMotions(root, machine.setup(), folder);
  plan.machines = ReadMachines(root, machine);
  plan.cases = ReadCases(root, {plan, machine});
  if (given != nullptr) RefuseKeys(root, plan);
  if (root.Has("ask")) {
    plan.ask = ReadAsk(root.Table("ask"));
  } else {
    plan.keep = ReadKeep(root, machine);
  }
  document.RefuseUnknownKeys();
  if (plan.machines.count >
      kMostRuns / std::max<std::int64_t>(plan.RunsOfAMachine(), 1)) {
    root.Fail("asks for more than ten million runs", "fewer points or machines");
  }
  return {std::move(plan), std::move(machine)};
}

}  // namespace

LoadedPlan ReadPlan(const std::filesystem::path& file) {
  return ParsePlan(ReadTextFile(file), file.parent_path(), file.string());
}

LoadedPlan ParsePlan(const std::string& text, const std::filesystem::path& folder,
                     const std::string& where) {
  LoadedPlan loaded = Read(TomlDocument(where, text), text, folder, nullptr);
  CheckPlan(loaded, where);
  return loaded;
}

LoadedPlan ParsePlanFor(const Machine& machine, const std::string& text,
                        const std::string& where) {
  LoadedPlan loaded = Read(TomlDocument(where, text), text, {}, &machine);
  CheckPlan(loaded, where);
  return loaded;
}

}  // namespace mjdiag
