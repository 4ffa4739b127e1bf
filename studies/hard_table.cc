#include "mjdiag/studies/hard_table.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "mjdiag/signals/median.h"
#include "mjdiag/studies/count_cells.h"
#include "mjdiag/studies/hidden_effect.h"

namespace mjdiag {
namespace {

std::string ListWithProbabilities(const std::vector<FoundCause>& causes) {
  std::string text;
  for (const FoundCause& found : causes) {
    text += (text.empty() ? "" : "; ") + CauseWithValues(found.cause) + " (" +
            Cell(found.probability).text + ")";
  }
  return text.empty() ? "nothing" : text;
}

bool IsOutside(const HardOutcome& outcome) { return outcome.plan.outside; }
bool IsNothing(const HardOutcome& outcome) { return outcome.truth.empty(); }
bool IsKnown(const HardOutcome& outcome) {
  return !IsOutside(outcome) && !IsNothing(outcome);
}

/// Share of the mismatch on unseen motion that the extended plant takes away.
double GainOf(const HardOutcome& outcome) {
  return 1.0 - outcome.after / outcome.before;
}

using Which = std::function<bool(const HardOutcome&)>;

/// Counts of outcomes, and figures over them.
class OutcomeCounts {
 public:
  explicit OutcomeCounts(const std::vector<HardOutcome>& outcomes)
      : outcomes_(outcomes),
        table_{"What became of them",
               {"figure", "count", "[%]", "95 % interval [%]"},
               {},
               {"Intervals of Clopper and Pearson."}} {}

  void Add(const std::string& what, const Which& among, const Which& holds) {
    int of = 0;
    int count = 0;
    for (const HardOutcome& outcome : outcomes_) {
      if (!among(outcome)) continue;
      ++of;
      count += holds(outcome) ? 1 : 0;
    }
    AddCount(table_, what, count, of);
  }
  /// Median and largest.
  void AddFigure(const std::string& what, const Which& among,
                 const std::function<double(const HardOutcome&)>& figure) {
    std::vector<double> values;
    for (const HardOutcome& outcome : outcomes_) {
      if (among(outcome)) values.push_back(figure(outcome));
    }
    if (values.empty()) return;
    const double largest = *std::ranges::max_element(values);
    table_.rows.push_back(
        {what + ", median and largest",
         Cell(Median(Eigen::VectorXd::Map(values.data(), std::ssize(values)))).text +
             " and " + Cell(largest).text,
         "", ""});
  }
  StudyTable Take() { return std::move(table_); }

 private:
  const std::vector<HardOutcome>& outcomes_;
  StudyTable table_;
};

StudyTable CountsOf(const std::vector<HardOutcome>& outcomes) {
  OutcomeCounts counts(outcomes);
  for (const HardVerdict verdict : {HardVerdict::kRight, HardVerdict::kUndecided,
                                    HardVerdict::kWrong, HardVerdict::kSilent}) {
    counts.Add(std::string("catalogue, ") + WordOf(verdict), IsKnown,
               [=](const HardOutcome& o) { return o.verdict == verdict; });
  }
  counts.Add("catalogue, wrong with a probability above 0.9", IsKnown,
             [](const HardOutcome& o) { return o.IsWrongAbove(0.9); });
  for (std::size_t causes = 1; causes <= 3; ++causes) {
    counts.Add(
        "catalogue, right of " + std::to_string(causes) + " at once",
        [=](const HardOutcome& o) { return IsKnown(o) && o.truth.size() == causes; },
        [](const HardOutcome& o) { return o.verdict == HardVerdict::kRight; });
  }
  for (const OutsideVerdict verdict :
       {OutsideVerdict::kNothing, OutsideVerdict::kFamily, OutsideVerdict::kFalse}) {
    counts.Add(std::string("outside law, ") + WordOf(verdict), IsOutside,
               [=](const HardOutcome& o) { return o.outside == verdict; });
  }
  counts.Add("catalogue, every kind at its site", IsKnown,
             [](const HardOutcome& o) { return o.kinds_are_there; });
  counts.Add("outside law, its kind at its site", IsOutside,
             [](const HardOutcome& o) { return o.kinds_are_there; });
  counts.AddFigure("outside law, share of the mismatch on unseen motion taken away",
                   IsOutside, GainOf);
  counts.Add("nothing hidden, something claimed", IsNothing,
             [](const HardOutcome& o) { return o.IsClaim(); });
  counts.Add("nothing hidden, something named", IsNothing,
             [](const HardOutcome& o) { return !o.answer.causes.empty(); });
  const Which all = [](const HardOutcome&) { return true; };
  counts.Add("within the budget", all, [](const HardOutcome& o) {
    return o.answer.budget.used <= o.answer.budget.limit;
  });
  counts.AddFigure("time [s]", all, [](const HardOutcome& o) { return o.seconds; });
  return counts.Take();
}

StudyTable ReliabilityTable(const std::string& title, const std::string& of,
                            const std::string& what, const std::vector<Claim>& claims) {
  StudyTable table{title,
                   {"probability", "claims", "mean probability", "hold",
                    "share that holds", "95 % interval"},
                   {},
                   {of + "; intervals of Clopper and Pearson."}};
  StudyPlot plot{"Share of the " + what + " that are there over their probability",
                 "probability",
                 "share that holds",
                 {},
                 {}};
  for (const ReliabilityBin& bin : ReliabilityOf(claims)) {
    const double share = static_cast<double>(bin.hold) / bin.claims;
    const auto [low, high] = bin.interval;
    table.rows.push_back({Cell(bin.from).text + " to " + Cell(bin.to).text,
                          static_cast<double>(bin.claims), bin.mean,
                          static_cast<double>(bin.hold), share,
                          Cell(low).text + " to " + Cell(high).text});
    plot.points.push_back({bin.mean, share, low, high});
  }
  plot.curve = {{0.0, 0.0}, {1.0, 1.0}};
  if (!plot.points.empty()) table.plot = std::move(plot);
  return table;
}

std::vector<Cell> RowOf(const HardOutcome& outcome, std::uint64_t seed) {
  return {std::to_string(seed),
          ListOf(outcome.truth),
          std::to_string(outcome.fitted) + " + " + std::to_string(outcome.unseen),
          ListWithProbabilities(outcome.answer.causes),
          IsOutside(outcome) ? WordOf(outcome.outside) : WordOf(outcome.verdict),
          outcome.before,
          outcome.after,
          outcome.seconds};
}

}  // namespace

std::vector<StudyTable> SummariesOf(const std::vector<HardOutcome>& outcomes) {
  std::vector<Claim> names;
  std::vector<Claim> kinds;
  for (const HardOutcome& outcome : outcomes) {
    if (!IsOutside(outcome)) {
      names.insert(names.end(), outcome.claims.begin(), outcome.claims.end());
    }
    kinds.insert(kinds.end(), outcome.kind_claims.begin(), outcome.kind_claims.end());
  }
  return {CountsOf(outcomes),
          ReliabilityTable("Reliability of the probabilities",
                           "Of all causes that were named beside the catalogue's or "
                           "nothing",
                           "named causes", names),
          ReliabilityTable("Reliability of the probabilities of kinds",
                           "Of all kinds of physics at sites, beside outside laws, too",
                           "kinds", kinds)};
}

std::vector<StudyTable> HardStudy(const Machine& model, bool nothing,
                                  const StudyOptions& options) {
  StudyTable empty;
  empty.title =
      "Hidden in measurements of a machine that is not quite " + model.setup().name;
  empty.columns = {"seed",  "hidden",  "records fitted + unseen",
                   "found", "outcome", "unseen mismatch / noise before",
                   "after", "s"};
  empty.notes = {
      "All numbers of the plant are off by draws from what is known of them, the "
      "measurement has twice the physics steps of the model, and every cause adds at "
      "least 200 to the squared innovations beyond what wrong numbers explain and what "
      "the steps of the model hide.",
      "In brackets the probabilities of what was found. Two fitted records without an "
      "unseen one: the end of each is what no fit sees."};
  GrowingTable runs(std::move(empty), options.row);
  std::vector<HardOutcome> outcomes(static_cast<std::size_t>(options.runs));
  ParallelInOrder(
      options.runs,
      [&](int run) {
        const auto i = static_cast<std::size_t>(run);
        const std::uint64_t seed = options.seed + i;
        const HardPlan plan = nothing ? HardPlan{.causes = 0} : PlanOf(seed);
        outcomes[i] = RunHard(model, plan, seed);
        runs.Put(i, RowOf(outcomes[i], seed));
      },
      options.progress);
  std::vector<StudyTable> tables = SummariesOf(outcomes);
  tables.push_back(runs.table());
  return tables;
}

}  // namespace mjdiag
