#include "mjdiag/studies/random_fault_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/effects/draw.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/count_cells.h"
#include "mjdiag/studies/run_bound.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// So that draws are not the numbers that the noise is made of.
constexpr std::uint64_t kOwnStream = 0x9e3779b97f4a7c15ULL;

/// Deviations that are drawn of a fault: from `least` to the farthest on either side; 0:
/// it has none on that side.
struct Sides {
  double least = 0.0;
  double below = 0.0;
  double above = 0.0;
};

Sides SidesOf(const PlanAxis& axis) {
  Sides sides;
  for (const auto& [from, to] : axis.ranges) {
    (to < axis.healthy ? sides.below : sides.above) = std::abs(to - axis.healthy);
  }
  sides.least = std::abs(axis.ranges.front().from - axis.healthy);
  return sides;
}

/// Deviations from healthy: "zeta_x +0.2, gamma +0.01"; "none".
std::string ListFaults(const std::vector<DrawnAxis>& faults) {
  std::string text;
  for (const DrawnAxis& fault : faults) {
    std::array<char, 32> size{};
    std::snprintf(size.data(), size.size(), " %+.3g",
                  fault.value - fault.axis->healthy);
    text += (text.empty() ? "" : ", ") + fault.axis->name + size.data();
  }
  return text.empty() ? "none" : text;
}

bool AnyFault(const RandomOutcome& run,
              const std::function<bool(const RandomOutcome&, Index)>& holds) {
  for (Index i = 0; i < run.truth.size(); ++i) {
    if (holds(run, i)) return true;
  }
  return false;
}

/// Error of an estimate; none of a disturbance that is not there, whose magnitude has a
/// floor at 0.
bool HasError(const RandomOutcome& run, Index fault, Index parameters) {
  return !run.diverged && (fault < parameters || run.Nameable(fault));
}

double ErrorOverBound(const RandomOutcome& run, Index i) {
  return std::abs(run.reading.deviation[i] - run.truth[i]) / run.bound[i];
}

double ErrorOverSd(const RandomOutcome& run, Index i) {
  return std::abs(run.reading.deviation[i] - run.truth[i]) / run.reading.sd[i];
}

std::string NamesWhere(const RandomOutcome& run, const std::vector<std::string>& names,
                       const std::function<bool(Index)>& holds) {
  std::string text;
  for (Index i = 0; i < run.truth.size(); ++i) {
    if (!holds(i)) continue;
    text += (text.empty() ? "" : ", ") + names[static_cast<std::size_t>(i)];
  }
  return text.empty() ? "-" : text;
}

/// "zeta_x +0.2 (4e+05)": with its multiple of the bound.
std::string DrawnWithMultiples(const RandomOutcome& run,
                               const std::vector<std::string>& names) {
  std::string text;
  for (const DrawnAxis& fault : run.draw.faults) {
    const Index at =
        std::find(names.begin(), names.end(), fault.axis->name) - names.begin();
    text += (text.empty() ? "" : ", ") + ListFaults({fault}) + " (" +
            Cell(std::round(std::abs(run.truth[at]) / run.bound[at])).text + ")";
  }
  return text.empty() ? "none" : text;
}

std::vector<Cell> RowOf(const RandomOutcome& run, const std::vector<std::string>& names,
                        const Machine& machine) {
  const double from = static_cast<double>(run.draw.from) * machine.rates().tick();
  const std::string seed = std::to_string(run.draw.seed);
  if (run.diverged) {
    return {seed, Cell(from), "diverged", "-", "-",
            "-",  "-",        "-",        "-", ListFaults(run.draw.faults)};
  }
  const auto parameters =
      static_cast<Index>(names.size() - machine.setup().disturbances.size());
  double over_sd = 0.0;
  double over_bound = 0.0;
  for (Index i = 0; i < run.truth.size(); ++i) {
    if (!HasError(run, i, parameters)) continue;
    over_sd = std::max(over_sd, ErrorOverSd(run, i));
    over_bound = std::max(over_bound, ErrorOverBound(run, i));
  }
  const auto named = [&](Index i) {
    return static_cast<bool>(run.reading.named[static_cast<std::size_t>(i)]);
  };
  return {seed,
          Cell(from),
          run.Right() ? "right" : "wrong",
          Cell(run.reading.nis),
          Cell(over_sd),
          Cell(over_bound),
          NamesWhere(run, names, named),
          NamesWhere(run, names, [&](Index i) { return run.Missed(i); }),
          NamesWhere(run, names, [&](Index i) { return run.False(i); }),
          DrawnWithMultiples(run, names)};
}

StudyTable EmptyRuns(const Machine& machine, bool linear) {
  return {
      "Random faults of " + machine.setup().name + ", " + PlantName(linear),
      {"seed", "from [s]", "names", "NIS", "error / sd", "error / bound", "named",
       "missed", "false", "drawn (multiple of the bound)"},
      {},
      {"Names are right if every fault farther from healthy than " +
           Cell(kNameable).text +
           " standard deviations of its information bound is named and nothing that "
           "is not there; a fainter one that is there may be named or not.",
       "Errors are the largest of a run, over the standard deviation that the "
       "diagnosis claims and over the bound. The bound is that of this very record: "
       "all faults, phases of disturbances, dry friction and the state at its start "
       "unknown."}};
}

StudyTable Counts(const std::vector<RandomOutcome>& runs) {
  StudyTable table{"How often the names are right",
                   {"figure", "count", "[%]", "95 % interval [%]"},
                   {},
                   {"Intervals of Clopper and Pearson."}};
  const auto add = [&](const std::string& what,
                       const std::function<bool(const RandomOutcome&)>& among,
                       const std::function<bool(const RandomOutcome&)>& holds) {
    int of = 0;
    int count = 0;
    for (const RandomOutcome& run : runs) {
      if (run.diverged || !among(run)) continue;
      ++of;
      count += holds(run) ? 1 : 0;
    }
    AddCount(table, what, count, of);
  };
  const auto right = [](const RandomOutcome& run) { return run.Right(); };
  const auto all = [](const RandomOutcome&) { return true; };
  const auto faulty = [](const RandomOutcome& run) { return !run.draw.faults.empty(); };
  add("right names, all runs", all, right);
  add("right names, faulty runs", faulty, right);
  for (std::size_t n = 1; n <= 3; ++n) {
    add(
        "right names, " + std::to_string(n) + (n == 1 ? " fault" : " faults"),
        [n](const RandomOutcome& run) { return run.draw.faults.size() == n; }, right);
  }
  add(
      "right names, from rest",
      [&](const RandomOutcome& run) { return run.draw.from == 0 && faulty(run); },
      right);
  add(
      "right names, from the middle of the motion",
      [&](const RandomOutcome& run) { return run.draw.from > 0 && faulty(run); },
      right);
  add("a nameable fault missed, faulty runs", faulty, [](const RandomOutcome& run) {
    return AnyFault(run, [](const auto& r, Index i) { return r.Missed(i); });
  });
  add("a fault named that is not there, faulty runs", faulty,
      [](const RandomOutcome& run) {
        return AnyFault(run, [](const auto& r, Index i) { return r.False(i); });
      });
  add(
      "false alarms, healthy runs",
      [](const RandomOutcome& run) { return run.draw.faults.empty(); },
      [](const RandomOutcome& run) { return !run.Right(); });

  int present = 0;
  int nameable = 0;
  int faint_named = 0;
  int named = 0;
  int diverged = 0;
  double nis = 0.0;
  for (const RandomOutcome& run : runs) {
    diverged += run.diverged ? 1 : 0;
    if (run.diverged) continue;
    nis = std::max(nis, run.reading.nis);
    for (Index i = 0; i < run.truth.size(); ++i) {
      if (!run.Present(i)) continue;
      const bool is_named = run.reading.named[static_cast<std::size_t>(i)];
      ++present;
      nameable += run.Nameable(i) ? 1 : 0;
      named += run.Nameable(i) && is_named ? 1 : 0;
      faint_named += !run.Nameable(i) && is_named ? 1 : 0;
    }
  }
  AddCount(table, "nameable faults that are named", named, nameable);
  AddCount(table, "fainter faults that are named", faint_named, present - nameable);
  table.rows.push_back({"largest NIS", Cell(nis), "", ""});
  if (diverged > 0)
    AddCount(table, "runs that diverged", diverged, static_cast<int>(runs.size()));
  return table;
}

/// The value that this share of them does not exceed; sorted.
double Quantile(const std::vector<double>& sorted, double share) {
  const auto last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(share * last))];
}

StudyTable ErrorTable(const std::vector<RandomOutcome>& runs,
                      const std::vector<std::string>& names, Index parameters) {
  StudyTable table{
      "Errors over the information bound",
      {"fault", "runs", "bound, median", "rms", "50 %", "90 %", "95 %", "largest",
       "sd claimed, median", "inside 95 % interval [%]"},
      {},
      {"Columns from rms to the sd claimed are multiples of the bound of each "
       "run; 0.67, 1.64 and 1.96 are the quantiles of an estimate at the "
       "bound. A disturbance counts where it is nameable."}};
  const double half = TwoSidedNormalQuantile(1.0 - kConfidence);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto i = static_cast<Index>(k);
    std::vector<double> errors;
    std::vector<double> bounds;
    std::vector<double> claimed;
    double square = 0.0;
    int inside = 0;
    for (const RandomOutcome& run : runs) {
      if (!HasError(run, i, parameters)) continue;
      errors.push_back(ErrorOverBound(run, i));
      bounds.push_back(run.bound[i]);
      claimed.push_back(run.reading.sd[i] / run.bound[i]);
      square += errors.back() * errors.back();
      inside += ErrorOverSd(run, i) <= half ? 1 : 0;
    }
    if (errors.empty()) continue;
    for (auto* values : {&errors, &bounds, &claimed}) std::ranges::sort(*values);
    const auto count = static_cast<double>(errors.size());
    table.rows.push_back({names[k], Cell(count), Quantile(bounds, 0.5),
                          std::sqrt(square / count), Quantile(errors, 0.5),
                          Quantile(errors, 0.9), Quantile(errors, 0.95), errors.back(),
                          Quantile(claimed, 0.5), 100.0 * inside / count});
  }
  return table;
}

}  // namespace

RandomDraw DrawFaults(const AskNames& ask, const std::vector<PlanAxis>& axes,
                      Eigen::Index samples, std::uint64_t seed) {
  Random random(seed ^ kOwnStream);
  RandomDraw draw;
  draw.seed = seed;
  const bool healthy = random.Uniform(0.0, 1.0) < ask.healthy;
  const auto most = std::min(static_cast<std::size_t>(ask.most), axes.size());
  const std::size_t count = healthy ? 0 : 1 + random.Index(most);
  std::vector<std::size_t> places(axes.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(places[i], places[i + random.Index(axes.size() - i)]);
  }
  std::sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const PlanAxis& axis = axes[places[i]];
    const auto [least, below, above] = SidesOf(axis);
    const bool either = below > 0.0 && above > 0.0;
    const double sign = either ? random.Sign() : above > 0.0 ? 1.0 : -1.0;
    const double size = random.Log(least, sign > 0.0 ? above : below);
    draw.faults.push_back({&axis, axis.healthy + sign * size});
  }
  if (random.Uniform(0.0, 1.0) >= ask.from_rest) {
    const Eigen::Index half = samples / 2;
    draw.from = static_cast<Eigen::Index>(
        random.Index(static_cast<std::size_t>(std::max<Eigen::Index>(1, half))));
  }
  return draw;
}

bool RandomOutcome::Nameable(Index fault) const {
  return std::abs(truth[fault]) > kNameable * bound[fault];
}

bool RandomOutcome::Missed(Index fault) const {
  return Nameable(fault) && !reading.named[static_cast<std::size_t>(fault)];
}

bool RandomOutcome::False(Index fault) const {
  return !Present(fault) && reading.named[static_cast<std::size_t>(fault)];
}

bool RandomOutcome::Right() const {
  return !AnyFault(*this, [](const RandomOutcome& run, Index i) {
    return run.Missed(i) || run.False(i);
  });
}

RandomOutcome TryDraw(const LoadedPlan& loaded, const RunMaker& maker,
                      const RandomDraw& draw) {
  const StudyPlan& plan = loaded.plan;
  const Machine& machine = loaded.machine;
  PlannedRun run;
  run.seed = draw.seed;
  run.axes = draw.faults;
  RandomOutcome outcome;
  outcome.draw = draw;
  outcome.truth =
      DeviationsOf(machine.setup(), MakeFaultFamily(machine).Names(), FaultsOf(run));
  Record record;
  try {
    record = maker.Simulate(run);
  } catch (const NumericalError&) {
    outcome.diverged = true;
    return outcome;
  }
  outcome.bound = RunBound(machine, outcome.truth, record, draw.from, plan.linear);
  outcome.reading = Listen(
      machine, record.Slice(draw.from, record.samples() - draw.from), plan.linear);
  return outcome;
}

std::vector<StudyTable> AnswerTo(const AskNames& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const StudyPlan& plan = loaded.plan;
  const Machine& machine = loaded.machine;
  const RunMaker maker(loaded);
  const PlanCase& drawn = plan.cases.front();
  RequireFaults(drawn, AxisValues::kDrawn);
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  const auto parameters =
      static_cast<Index>(names.size() - machine.setup().disturbances.size());
  std::vector<RandomOutcome> outcomes(static_cast<std::size_t>(drawn.points));
  GrowingTable runs(EmptyRuns(machine, plan.linear), options.row);
  ParallelInOrder(
      drawn.points,
      [&](int run) {
        const auto i = static_cast<std::size_t>(run);
        outcomes[i] =
            TryDraw(loaded, maker,
                    DrawFaults(ask, drawn.axes, maker.motions().front().samples(),
                               plan.seed + i));
        runs.Put(i, RowOf(outcomes[i], names, machine));
      },
      options.progress);
  return {runs.table(), Counts(outcomes), ErrorTable(outcomes, names, parameters)};
}

}  // namespace mjdiag
