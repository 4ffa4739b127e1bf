#include "mjdiag/studies/hidden_table.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "mjdiag/signals/median.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/count_cells.h"
#include "mjdiag/studies/hidden_effect.h"

namespace mjdiag {
namespace {

std::string ListOf(const std::vector<FoundCause>& causes, bool with_probabilities) {
  std::string text;
  for (const FoundCause& found : causes) {
    text += (text.empty() ? "" : "; ") + CauseWithValues(found.cause);
    if (with_probabilities) text += " (" + Cell(found.probability).text + ")";
  }
  return text.empty() ? "nothing" : text;
}

bool IsOutside(const HiddenOutcome& outcome) { return outcome.plan.outside; }
bool IsNothing(const HiddenOutcome& outcome) { return outcome.truth.empty(); }
bool IsKnown(const HiddenOutcome& outcome) {
  return !IsOutside(outcome) && !IsNothing(outcome);
}

/// Share of the mismatch on unseen motion that the extended plant takes away.
double GainOf(const HiddenOutcome& outcome) {
  return 1.0 - outcome.after / outcome.before;
}

using Which = std::function<bool(const HiddenOutcome&)>;

/// Counts of outcomes, and figures over them.
class OutcomeCounts {
 public:
  explicit OutcomeCounts(const std::vector<HiddenOutcome>& outcomes)
      : outcomes_(outcomes),
        table_{"What became of them",
               {"figure", "count", "[%]", "95 % interval [%]"},
               {},
               {"Intervals of Clopper and Pearson."}} {}

  void Add(const std::string& what, const Which& among, const Which& holds) {
    int of = 0;
    int count = 0;
    for (const HiddenOutcome& outcome : outcomes_) {
      if (!among(outcome)) continue;
      ++of;
      count += holds(outcome) ? 1 : 0;
    }
    AddCount(table_, what, count, of);
  }
  /// Median and largest.
  void AddFigure(const std::string& what, const Which& among,
                 const std::function<double(const HiddenOutcome&)>& figure) {
    std::vector<double> values;
    for (const HiddenOutcome& outcome : outcomes_) {
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
  const std::vector<HiddenOutcome>& outcomes_;
  StudyTable table_;
};

StudyTable CountsOf(const std::vector<HiddenOutcome>& outcomes) {
  OutcomeCounts counts(outcomes);
  for (const HiddenVerdict verdict : {HiddenVerdict::kRight, HiddenVerdict::kUndecided,
                                      HiddenVerdict::kWrong, HiddenVerdict::kSilent}) {
    counts.Add(std::string("catalogue, ") + WordOf(verdict), IsKnown,
               [=](const HiddenOutcome& o) { return o.verdict == verdict; });
  }
  counts.Add("catalogue, wrong with a probability above 0.9", IsKnown,
             [](const HiddenOutcome& o) { return o.IsWrongAbove(0.9); });
  for (std::size_t causes = 1; causes <= 3; ++causes) {
    counts.Add(
        "catalogue, right of " + std::to_string(causes) + " at once",
        [=](const HiddenOutcome& o) { return IsKnown(o) && o.truth.size() == causes; },
        [](const HiddenOutcome& o) { return o.verdict == HiddenVerdict::kRight; });
  }
  for (const OutsideVerdict verdict :
       {OutsideVerdict::kNothing, OutsideVerdict::kFamily, OutsideVerdict::kFalse}) {
    counts.Add(std::string("outside law, ") + WordOf(verdict), IsOutside,
               [=](const HiddenOutcome& o) { return o.outside == verdict; });
  }
  counts.Add("catalogue, every kind at its site", IsKnown,
             [](const HiddenOutcome& o) { return o.kinds_are_there; });
  counts.Add("outside law, its kind at its site", IsOutside,
             [](const HiddenOutcome& o) { return o.kinds_are_there; });
  counts.AddFigure("outside law, share of the mismatch on unseen motion taken away",
                   IsOutside, GainOf);
  counts.Add("nothing hidden, something claimed", IsNothing,
             [](const HiddenOutcome& o) { return o.IsClaim(); });
  counts.Add("nothing hidden, something named", IsNothing,
             [](const HiddenOutcome& o) { return !o.answer.causes.empty(); });
  const Which all = [](const HiddenOutcome&) { return true; };
  counts.Add("within the budget", all, [](const HiddenOutcome& o) {
    return o.answer.budget.used <= o.answer.budget.limit;
  });
  counts.AddFigure("time [s]", all, [](const HiddenOutcome& o) { return o.seconds; });
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

std::vector<Cell> RowOf(const HiddenOutcome& outcome, std::uint64_t seed) {
  return {std::to_string(seed),
          ListOf(outcome.truth),
          std::to_string(outcome.fitted) + " + " + std::to_string(outcome.unseen),
          ListOf(outcome.answer.causes, true),
          IsOutside(outcome) ? WordOf(outcome.outside) : WordOf(outcome.verdict),
          outcome.before,
          outcome.after,
          outcome.seconds};
}

StudyTable NoRows(const Machine& model) {
  return {
      "Hidden in measurements of a machine that is not quite " + model.setup().name,
      {"seed", "hidden", "records fitted + unseen", "found", "outcome",
       "unseen mismatch / noise before", "after", "s"},
      {},
      {"All numbers of the plant are off by draws from what is known of them, the "
       "measurement has twice the physics steps of the model, and every cause adds at "
       "least 200 to the squared innovations beyond what wrong numbers explain and "
       "what "
       "the steps of the model hide.",
       "In brackets the probabilities of what was found. Two fitted records without an "
       "unseen one: the end of each is what no fit sees."}};
}

/// What is hidden in the case of that seed.
HiddenPlan PlanFor(const AskHidden& ask, std::uint64_t seed) {
  HiddenPlan plan = ask.causes ? HiddenPlan{.causes = *ask.causes} : PlanOf(seed);
  plan.exact = ask.exact;
  return plan;
}

// Of an exact model:

StudyTable ExactSummary(const std::vector<HiddenOutcome>& outcomes, bool nothing) {
  int right = 0;
  int undecided = 0;
  int claims = 0;
  int close = 0;  // of the right ones
  Coverage covered;
  for (const HiddenOutcome& outcome : outcomes) {
    claims += outcome.IsClaim() ? 1 : 0;
    undecided += outcome.verdict == HiddenVerdict::kUndecided ? 1 : 0;
    if (!outcome.IsRight()) continue;
    ++right;
    covered.parameters += outcome.coverage.parameters;
    covered.inside += outcome.coverage.inside;
    close += outcome.after_worst <= 1.2 ? 1 : 0;
  }
  const auto all = static_cast<int>(outcomes.size());
  StudyTable table{"How often it is right", {"figure", "value"}, {}, {}};
  if (nothing) {
    table.rows = {
        {"runs with a claim that something is there", CountText(claims, all)}};
    return table;
  }
  table.rows = {
      {"type and site right, and nothing else", CountText(right, all)},
      {"others: the truth given as what the record does not tell from what is named",
       CountText(undecided, all)},
      {"of the right ones, parameters inside their 95 % interval",
       CountText(covered.inside, covered.parameters)},
      {"of the right ones, mismatch on unseen motion within 1.2 times the noise floor",
       CountText(close, right)}};
  return table;
}

std::vector<Cell> ExactRow(const HiddenOutcome& outcome, std::uint64_t seed) {
  const std::vector<FoundCause>& found = outcome.answer.causes;
  return {std::to_string(seed),
          ListOf(outcome.truth),
          ListOf(found, false),
          outcome.IsRight()                              ? "yes"
          : outcome.verdict == HiddenVerdict::kUndecided ? "not told apart"
                                                         : "no",
          found.empty() ? Cell("-") : Cell(found.front().probability),
          CountText(outcome.coverage.inside, outcome.coverage.parameters),
          outcome.after_worst,
          outcome.seconds};
}

StudyTable NoExactRows(const Machine& model) {
  return {
      "Effects hidden in simulated measurements of " + model.setup().name,
      {"seed", "hidden", "found", "right", "p", "parameters covered",
       "unseen mismatch / floor", "s"},
      {},
      {"Sizes are drawn evenly in the logarithm of what an effect adds to the squared "
       "innovations, from 200 (14 standard deviations) to 1e8, or to the largest that "
       "a "
       "machine has.",
       "A fault parameter and the effect that changes the same attribute of the model "
       "count as one: no measurement tells them apart."}};
}

}  // namespace

std::vector<StudyTable> SummariesOf(const std::vector<HiddenOutcome>& outcomes) {
  std::vector<Claim> names;
  std::vector<Claim> kinds;
  for (const HiddenOutcome& outcome : outcomes) {
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

std::vector<StudyTable> AnswerTo(const AskHidden& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const Machine& model = loaded.machine;
  const int count = loaded.plan.replications;
  GrowingTable runs(ask.exact ? NoExactRows(model) : NoRows(model), options.row);
  std::vector<HiddenOutcome> outcomes(static_cast<std::size_t>(count));
  // Several at once: much of a discovery waits for its longest run.
  ParallelInOrder(
      count,
      [&](int run) {
        const auto i = static_cast<std::size_t>(run);
        const std::uint64_t seed = loaded.plan.seed + i;
        outcomes[i] = RunHidden(model, PlanFor(ask, seed), seed);
        runs.Put(i, ask.exact ? ExactRow(outcomes[i], seed) : RowOf(outcomes[i], seed));
      },
      options.progress);
  std::vector<StudyTable> tables =
      ask.exact ? std::vector{ExactSummary(outcomes, ask.causes == 0)}
                : SummariesOf(outcomes);
  tables.push_back(runs.table());
  return tables;
}

}  // namespace mjdiag
