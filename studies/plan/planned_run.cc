#include "mjdiag/studies/plan/planned_run.h"

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "mjdiag/plugin/effects/draw.h"

namespace mjdiag {
namespace {

/// What a generator is seeded for.
enum Purpose : std::uint64_t { kMachine = 1, kPoint, kShift, kSplit, kNoise };

/// SplitMix64 (Steele, Lea and Flood): neighbouring numbers become unrelated ones.
std::uint64_t Mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

std::uint64_t SeedFor(std::uint64_t seed, std::initializer_list<std::uint64_t> of) {
  std::uint64_t mixed = Mixed(seed);
  for (const std::uint64_t part : of) mixed = Mixed(mixed ^ part);
  return mixed;
}

bool IsWrong(AxisKind kind) {
  return kind == AxisKind::kFault || kind == AxisKind::kDisturbance ||
         kind == AxisKind::kEffect;
}

double In(const PlanAxis& axis, const ValueRange& range, double share) {
  if (!axis.logarithmic) return range.from + share * (range.to - range.from);
  const double first = range.from - axis.healthy;
  const double last = range.to - axis.healthy;
  return axis.healthy + first * std::pow(last / first, share);
}

/// Part `u` of `count` equal ones, and where in it.
std::size_t TakePart(double& u, std::size_t count) {
  const double scaled = u * static_cast<double>(count);
  const std::size_t part = std::min(static_cast<std::size_t>(scaled), count - 1);
  u = scaled - static_cast<double>(part);
  return part;
}

/// Without the first the others would not be even: 2^k points that begin with it have one in
/// every part of 2^-k of an axis (A. B. Owen, "On dropping the first Sobol' point",
/// arXiv:2008.08051).
std::vector<double> SobolPoint(int dimensions, std::uint64_t number) {
  std::vector<double> point(static_cast<std::size_t>(dimensions), 0.0);
  if (number == 0) return point;  // which Boost leaves out
  boost::random::sobol sequence(point.size());
  sequence.discard((number - 1) * static_cast<std::uint64_t>(dimensions));
  constexpr double kUnit = 0x1p-64;
  for (double& u : point) u = static_cast<double>(sequence()) * kUnit;
  return point;
}

/// The axes of its own that vary: `how_many` and a number for each to rank them by.
std::vector<bool> Chosen(const PlanCase& one, double how_many, const double* ranks) {
  const std::size_t own = one.axes.size() - one.common;
  const auto [least, most] = *one.choose;
  const std::size_t count =
      static_cast<std::size_t>(least) +
      TakePart(how_many, static_cast<std::size_t>(most - least + 1));
  std::vector<std::size_t> order(own);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return ranks[i]; });
  std::vector<bool> chosen(one.axes.size(), true);
  for (std::size_t i = count; i < own; ++i) chosen[one.common + order[i]] = false;
  return chosen;
}

std::vector<Split> AssignSplits(const StudyPlan& plan) {
  const auto count = static_cast<std::size_t>(plan.machines.count);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    return SeedFor(plan.seed, {kSplit, i});
  });
  const auto& shares = plan.machines.shares;
  const auto edge = [&](double share) {
    return static_cast<std::size_t>(std::lround(share * static_cast<double>(count)));
  };
  std::vector<Split> splits(count, Split::kTest);
  for (std::size_t i = 0; i < count; ++i) {
    if (i < edge(shares[0])) {
      splits[order[i]] = Split::kTrain;
    } else if (i < edge(shares[0] + shares[1])) {
      splits[order[i]] = Split::kValidation;
    }
  }
  return splits;
}

std::vector<PlanColumn> ColumnsOf(const StudyPlan& plan) {
  std::vector<PlanColumn> columns;
  for (const PlanCase& one : plan.cases) {
    for (const PlanAxis& axis : one.axes) {
      if (std::ranges::find(columns, axis.name, &PlanColumn::name) == columns.end()) {
        columns.push_back({axis.name, axis.unit, axis.kind, axis.healthy});
      }
    }
  }
  return columns;
}

}  // namespace

bool DrawnAxis::present() const {
  return varies && IsWrong(axis->kind) && value != axis->healthy;
}

std::string PlannedRun::Label() const {
  std::vector<std::string> names;
  for (const DrawnAxis& drawn : axes) {
    if (!drawn.present()) continue;
    // The parameters of an effect are one cause.
    const bool is_effect = drawn.axis->kind == AxisKind::kEffect;
    const std::string& name = is_effect ? drawn.axis->effect : drawn.axis->name;
    const std::string cause = name.substr(0, name.find(':'));
    if (std::ranges::find(names, cause) == names.end()) names.push_back(cause);
  }
  std::string label;
  for (const std::string& name : names) label += (label.empty() ? "" : " + ") + name;
  return label.empty() ? "healthy" : label;
}

double ValueAt(const PlanAxis& axis, double u) {
  if (!axis.values.empty()) return axis.values[TakePart(u, axis.values.size())];
  const ValueRange& range = axis.ranges[TakePart(u, axis.ranges.size())];
  return In(axis, range, u);
}

std::vector<double> GridValues(const PlanAxis& axis) {
  if (!axis.values.empty()) return axis.values;
  std::vector<double> values;
  for (const ValueRange& range : axis.ranges) {
    for (int i = 0; i < axis.points; ++i) {
      values.push_back(
          i == 0 ? range.from
          : i + 1 == axis.points
              ? range.to
              : In(axis, range, static_cast<double>(i) / (axis.points - 1)));
    }
  }
  return values;
}

RunPlanner::RunPlanner(const StudyPlan& plan)
    : plan_(plan), splits_(AssignSplits(plan)), columns_(ColumnsOf(plan)) {}

NumberFactors RunPlanner::NumbersOf(int machine) const {
  Random random(SeedFor(plan_.seed, {kMachine, static_cast<std::uint64_t>(machine)}));
  NumberFactors factors;
  for (const auto& [number, sd] : plan_.machines.numbers) {
    factors.emplace_back(number, std::exp(sd * random.Normal()));
  }
  return factors;
}

std::vector<double> RunPlanner::Coordinates(std::size_t in_case, int machine,
                                            int point) const {
  const PlanCase& one = plan_.cases[in_case];
  const int dimensions = one.dimensions();
  if (dimensions == 0) return {};
  std::vector<double> coordinates(static_cast<std::size_t>(dimensions));
  if (one.method == PlanMethod::kSobol) {
    const auto number =
        static_cast<std::uint64_t>(machine) * static_cast<std::uint64_t>(one.points) +
        static_cast<std::uint64_t>(point);
    coordinates = SobolPoint(dimensions, number);
    Random shift(SeedFor(plan_.seed, {kShift, in_case}));
    for (double& u : coordinates) {
      u += shift.Uniform(0.0, 1.0);
      u -= std::floor(u);
    }
  } else {
    Random random(SeedFor(plan_.seed, {kPoint, static_cast<std::uint64_t>(machine),
                                       in_case, static_cast<std::uint64_t>(point)}));
    for (double& u : coordinates) u = random.Uniform(0.0, 1.0);
  }
  return coordinates;
}

PlannedRun RunPlanner::Run(std::int64_t index) const {
  PlannedRun run;
  run.index = index;
  run.machine = static_cast<int>(index / plan_.RunsOfAMachine());
  run.split = SplitOf(run.machine);
  run.numbers = NumbersOf(run.machine);

  std::int64_t rest = index % plan_.RunsOfAMachine();
  run.replication = static_cast<int>(rest % plan_.replications);
  rest /= plan_.replications;
  const auto motions = static_cast<std::int64_t>(plan_.motions.size());
  run.motion = static_cast<int>(rest % motions);
  rest /= motions;
  std::int64_t points = 0;  // of a machine
  for (const PlanCase& one : plan_.cases) points += one.points;
  run.point = run.machine * points + rest;
  std::size_t in_case = 0;
  while (rest >= plan_.cases[in_case].points) rest -= plan_.cases[in_case++].points;
  run.in_case = static_cast<int>(in_case);

  const PlanCase& one = plan_.cases[in_case];
  const std::int64_t drawn_before = one.method == PlanMethod::kRandom ? rest : 0;
  run.seed = plan_.ask
                 ? plan_.seed + static_cast<std::uint64_t>(
                                    drawn_before * plan_.replications + run.replication)
                 : SeedFor(plan_.seed, {kNoise, static_cast<std::uint64_t>(index)});
  const std::vector<double> u =
      Coordinates(in_case, run.machine, static_cast<int>(rest));
  std::size_t next = 0;
  std::int64_t digits = rest;
  for (const PlanAxis& axis : one.axes) {
    DrawnAxis drawn{&axis};
    if (one.method == PlanMethod::kOneAtATime) {
      const std::vector<double> values = GridValues(axis);
      const auto count = static_cast<std::int64_t>(values.size());
      drawn.varies = digits >= 0 && digits < count;
      drawn.value =
          drawn.varies ? values[static_cast<std::size_t>(digits)] : axis.healthy;
      digits -= count;
      ++next;
    } else if (one.method == PlanMethod::kGrid) {
      const std::vector<double> values = GridValues(axis);
      const auto count = static_cast<std::int64_t>(values.size());
      drawn.value = values[static_cast<std::size_t>(digits % count)];
      digits /= count;
      ++next;
    } else {
      drawn.value = ValueAt(axis, u[next++]);
    }
    if (axis.appears) {
      const auto& [from, to] = *axis.appears;
      drawn.time = from + u[next++] * (to - from);
    }
    run.axes.push_back(drawn);
  }
  if (one.choose) {
    const std::vector<bool> chosen = Chosen(one, u[next], &u[next + 1]);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i]) continue;
      run.axes[i].varies = false;
      run.axes[i].value = run.axes[i].axis->healthy;
    }
  }
  return run;
}

std::vector<double> RunPlanner::ValuesOf(const PlannedRun& run) const {
  std::vector<double> values;
  values.reserve(columns_.size());
  for (const PlanColumn& column : columns_) {
    values.push_back(column.kind == AxisKind::kKey
                         ? std::numeric_limits<double>::quiet_NaN()
                         : column.healthy);
    for (const DrawnAxis& drawn : run.axes) {
      if (drawn.axis->name == column.name) values.back() = drawn.value;
    }
  }
  return values;
}

std::vector<double> RunPlanner::TimesOf(const PlannedRun& run) const {
  std::vector<double> times(columns_.size(), 0.0);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    for (const DrawnAxis& drawn : run.axes) {
      if (drawn.axis->name == columns_[i].name && drawn.varies) times[i] = drawn.time;
    }
  }
  return times;
}

}  // namespace mjdiag
