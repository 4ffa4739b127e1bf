#include "mjdiag/studies/hidden_table.h"

#include <algorithm>
#include <chrono>
#include <string>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/hidden_study.h"

namespace mjdiag {
namespace {

std::string List(const std::vector<Cause>& causes) {
  std::string text;
  for (const Cause& cause : causes)
    text += (text.empty() ? "" : "; ") + Describe(cause);
  return text.empty() ? "nothing" : text;
}

std::string List(const std::vector<FoundCause>& causes) {
  std::string text;
  for (const FoundCause& found : causes) {
    text += (text.empty() ? "" : "; ") + Describe(found.cause);
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

std::string Of(int part, int whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

StudyTable Summary(const Count& count, int causes) {
  StudyTable table;
  table.title = "How often it is right";
  table.columns = {"figure", "value"};
  if (causes == 0) {
    table.rows.push_back(
        {"runs with a claim that something is there", Of(count.claims, count.runs)});
    return table;
  }
  table.rows.push_back(
      {"type and site right, and nothing else", Of(count.right, count.runs)});
  table.rows.push_back(
      {"others: the truth given as what the record does not tell from what is named",
       Of(count.undecided, count.runs)});
  table.rows.push_back({"of the right ones, parameters inside their 95 % interval",
                        Of(count.covered, count.parameters)});
  table.rows.push_back(
      {"of the right ones, mismatch on unseen motion within 1.2 times "
       "the noise floor",
       Of(count.close, count.right)});
  return table;
}

}  // namespace

std::vector<StudyTable> HiddenStudy(const Machine& machine, int causes,
                                    const StudyOptions& options) {
  using Clock = std::chrono::steady_clock;
  StudyTable runs;
  runs.title = "Effects hidden in simulated measurements of " + machine.setup().name;
  runs.columns = {"seed",
                  "hidden",
                  "found",
                  "right",
                  "p",
                  "parameters covered",
                  "unseen mismatch / floor",
                  "s"};
  std::vector<HiddenOutcome> outcomes(static_cast<std::size_t>(options.runs));
  std::vector<double> seconds(outcomes.size());
  // Several at once: much of a discovery waits for its longest run.
  ParallelFor(
      options.runs,
      [&](int run) {
        const auto i = static_cast<std::size_t>(run);
        const std::uint64_t seed = options.seed + i;
        const auto start = Clock::now();
        outcomes[i] =
            RunHidden(machine, TypesOfRun(static_cast<int>(seed - 1), causes), seed);
        seconds[i] = std::chrono::duration<double>(Clock::now() - start).count();
      },
      options.progress);
  Count count;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const HiddenOutcome& outcome = outcomes[i];
    Add(outcome, count);
    const bool named = !outcome.answer.causes.empty();
    runs.rows.push_back(
        {std::to_string(options.seed + i), List(outcome.hidden.truth),
         List(outcome.answer.causes),
         outcome.right       ? "yes"
         : outcome.undecided ? "not told apart"
                             : "no",
         named ? Cell(outcome.answer.causes.front().probability) : Cell("-"),
         Of(outcome.covered, outcome.parameters), outcome.unseen_ratio, seconds[i]});
  }
  runs.notes = {
      "Sizes are drawn evenly in the logarithm of what an effect adds to the squared "
      "innovations, from 200 (14 standard deviations) to 1e8, or to the largest that a "
      "machine has.",
      "A fault parameter and the effect that changes the same attribute of the model "
      "count as one: no measurement tells them apart."};
  return {Summary(count, causes), runs};
}

}  // namespace mjdiag
