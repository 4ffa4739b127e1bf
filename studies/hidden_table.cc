#include "mjdiag/studies/hidden_table.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "mjdiag/studies/count_cells.h"
#include "mjdiag/studies/hidden_effect.h"
#include "mjdiag/studies/hidden_study.h"

namespace mjdiag {
namespace {

std::string ListOf(const std::vector<FoundCause>& causes) {
  std::string text;
  for (const FoundCause& found : causes) {
    text += (text.empty() ? "" : "; ") + CauseWithValues(found.cause);
  }
  return text.empty() ? "nothing" : text;
}

struct Count {
  int runs = 0;
  int right = 0;
  int undecided = 0;
  int claims = 0;
  int parameters = 0;
  int covered = 0;
  int close = 0;  ///< of the right ones, unseen mismatch within 1.2 of the floor
};

void Add(const HiddenOutcome& outcome, Count& count) {
  ++count.runs;
  count.right += outcome.right;
  count.undecided += outcome.undecided;
  count.claims += outcome.claim;
  count.parameters += outcome.right ? outcome.parameters : 0;
  count.covered += outcome.right ? outcome.covered : 0;
  count.close += outcome.right && outcome.unseen_ratio <= 1.2;
}

StudyTable Summary(const Count& count, int causes) {
  StudyTable table;
  table.title = "How often it is right";
  table.columns = {"figure", "value"};
  if (causes == 0) {
    table.rows.push_back({"runs with a claim that something is there",
                          CountText(count.claims, count.runs)});
    return table;
  }
  table.rows.push_back(
      {"type and site right, and nothing else", CountText(count.right, count.runs)});
  table.rows.push_back(
      {"others: the truth given as what the record does not tell from what is named",
       CountText(count.undecided, count.runs)});
  table.rows.push_back({"of the right ones, parameters inside their 95 % interval",
                        CountText(count.covered, count.parameters)});
  table.rows.push_back(
      {"of the right ones, mismatch on unseen motion within 1.2 times "
       "the noise floor",
       CountText(count.close, count.right)});
  return table;
}

std::vector<Cell> RowOf(const HiddenOutcome& outcome, std::uint64_t seed,
                        double seconds) {
  const bool named = !outcome.answer.causes.empty();
  return {std::to_string(seed),
          ListOf(outcome.hidden.truth),
          ListOf(outcome.answer.causes),
          outcome.right       ? "yes"
          : outcome.undecided ? "not told apart"
                              : "no",
          named ? Cell(outcome.answer.causes.front().probability) : Cell("-"),
          CountText(outcome.covered, outcome.parameters),
          outcome.unseen_ratio,
          seconds};
}

}  // namespace

std::vector<StudyTable> HiddenStudy(const Machine& machine, int causes,
                                    const StudyOptions& options) {
  using Clock = std::chrono::steady_clock;
  StudyTable empty;
  empty.title = "Effects hidden in simulated measurements of " + machine.setup().name;
  empty.columns = {"seed",
                   "hidden",
                   "found",
                   "right",
                   "p",
                   "parameters covered",
                   "unseen mismatch / floor",
                   "s"};
  empty.notes = {
      "Sizes are drawn evenly in the logarithm of what an effect adds to the squared "
      "innovations, from 200 (14 standard deviations) to 1e8, or to the largest that a "
      "machine has.",
      "A fault parameter and the effect that changes the same attribute of the model "
      "count as one: no measurement tells them apart."};
  GrowingTable runs(std::move(empty), options.row);
  std::vector<HiddenOutcome> outcomes(static_cast<std::size_t>(options.runs));
  // Several at once: much of a discovery waits for its longest run.
  ParallelInOrder(
      options.runs,
      [&](int run) {
        const auto i = static_cast<std::size_t>(run);
        const std::uint64_t seed = options.seed + i;
        const auto start = Clock::now();
        outcomes[i] =
            RunHidden(machine, TypesOfRun(static_cast<int>(seed - 1), causes), seed);
        const double seconds =
            std::chrono::duration<double>(Clock::now() - start).count();
        runs.Put(i, RowOf(outcomes[i], seed, seconds));
      },
      options.progress);
  Count count;
  for (const HiddenOutcome& outcome : outcomes) Add(outcome, count);
  return {Summary(count, causes), runs.table()};
}

}  // namespace mjdiag
