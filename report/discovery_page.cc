#include "mjdiag/report/discovery_page.h"

#include <algorithm>

#include "mjdiag/report/cause_text.h"
#include "mjdiag/report/discovery_plots.h"
#include "mjdiag/report/discovery_text.h"
#include "mjdiag/report/kinds_text.h"
#include "mjdiag/report/mismatch_tables.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

constexpr std::size_t kMostChannels = 3;

std::string ShareText(double share) { return FormatNumber(100.0 * share) + " %"; }

Tone ToneOf(DiscoveryVerdict verdict) {
  switch (verdict) {
    case DiscoveryVerdict::kNoDiscrepancy:
    case DiscoveryVerdict::kExplained:
      return Tone::kGood;
    case DiscoveryVerdict::kPartlyExplained:
      return Tone::kNeutral;
    case DiscoveryVerdict::kUnexplained:
      return Tone::kBad;
  }
  return Tone::kNeutral;
}

void AddDiscoveryFacts(Page& page, const Discovery& discovery,
                       const DiscoveryRun& run) {
  const RecordReplay* first = discovery.Fitted();
  std::vector<std::pair<std::string, std::string>> facts = {{"Setup", discovery.setup},
                                                            {"Record", run.run.record}};
  if (!run.validation.empty()) facts.emplace_back("Validation", run.validation);
  if (first != nullptr) {
    const Record& record = first->before.measured;
    facts.emplace_back("Length", std::to_string(record.samples()) + " samples at " +
                                     FormatQuantity(1.0 / record.sample_time(), "Hz") +
                                     ", " + FormatQuantity(record.duration(), "s"));
    facts.emplace_back("Replayed", first->before.closed_loop
                                       ? "measured reference, in closed loop"
                                       : "measured input, in open loop");
  }
  const auto seen = std::ranges::count(discovery.records, true, &RecordReplay::seen);
  const double share = discovery.train_share;
  const std::string part =
      share > 0.0 && share < 1.0 ? "the first " + ShareText(share) + " of " : "";
  if (seen > 1) {
    facts.emplace_back("Fitted to", part + std::to_string(seen) + " records");
  } else if (!part.empty()) {
    facts.emplace_back("Fitted to", part + "the record");
  }
  if (!run.extended_plant.empty()) {
    facts.emplace_back("Extended plant", run.extended_plant);
  }
  page.AddFacts(facts);
}

constexpr const char* kHowToReadCauses =
    "Intervals hold the true value in 95 of 100 such records. The probability is that "
    "of the cause among all candidates that could take its place; candidates below 1 % "
    "are not listed.";

constexpr const char* kHowToReadExplanations =
    "What the record leaves possible: the causes that were found, and sets in which "
    "one of them is exchanged for a candidate of its place. Sets below 1 % are not "
    "listed.";

constexpr const char* kHowToReadKinds =
    "The kind of physics that the model lacks and where, whichever law it follows: the "
    "probability is what data that no fit saw say against the best model without it. A "
    "law "
    "that is in no list makes the names below less certain, and the kind not.";

void AddKinds(Page& page, const Discovery& discovery) {
  const Table table = KindTable(discovery);
  if (table.rows.empty()) return;
  page.AddHeading("Kinds of physics");
  page.AddTable(table);
  page.AddParagraph(kHowToReadKinds);
}

void AddCauses(Page& page, const Discovery& discovery) {
  if (discovery.causes.empty()) return;
  page.AddHeading("Causes");
  page.AddTable(CauseTable(discovery));
  page.AddHeading("Candidates");
  page.AddTable(CandidateTable(discovery));
  page.AddParagraph(kHowToReadCauses);
  const Table resistances = ResistanceTable(discovery);
  if (!resistances.rows.empty()) {
    page.AddHeading("What resists a joint");
    page.AddTable(resistances);
    page.AddParagraph(
        "All laws that resist a joint together: the friction that a controller has to "
        "make up for.");
  }
  const Table explanations = ExplanationTable(discovery);
  if (explanations.rows.empty()) return;
  page.AddHeading("Explanations");
  page.AddTable(explanations);
  page.AddParagraph(kHowToReadExplanations);
}

void AddCalibration(Page& page, const Discovery& discovery) {
  const Table table = CalibrationTable(discovery);
  const Table moments = MomentTable(discovery);
  if (table.rows.empty() && moments.rows.empty()) return;
  page.AddHeading("Numbers of the plant");
  if (!table.rows.empty()) page.AddTable(table);
  if (!moments.rows.empty()) page.AddTable(moments);
  page.AddParagraph(
      "Fitted with the causes and written into the extended plant. Numbers that the "
      "record does not tell better than they were known, or that are as the model "
      "says, "
      "are not listed.");
}

void AddNotes(Page& page, const Discovery& discovery) {
  if (discovery.notes.empty()) return;
  page.AddHeading("Notes");
  for (const std::string& note : discovery.notes) page.AddParagraph(note);
}

constexpr const char* kHowToReadLadder =
    "Rest over noise: what an observer beside the plant fails to predict, over the "
    "noise of the sensors, root mean square; 1 says that noise is all there is. The "
    "errors are those of a replay "
    "of the whole record, relative to the measured signal.";

void AddLadder(Page& page, const Discovery& discovery) {
  if (discovery.ladder.empty()) return;
  page.AddHeading("After each cause");
  page.AddTable(LadderTable(discovery));
  page.AddParagraph(kHowToReadLadder);
  const Table validation = ValidationLadderTable(discovery);
  if (validation.rows.empty()) return;
  page.AddHeading("After each cause, on the validation record");
  page.AddTable(validation);
}

constexpr const char* kHowToReadMismatch =
    "Mismatch is measured minus simulated, root mean square. ";

constexpr const char* kFittedAndUnseen =
    "Fitted: the part of the record that fits saw. Unseen: the validation record if "
    "there is one, else the rest of the record. The noise floor is what the sensor "
    "noise "
    "found in the record explains.";

std::string Fell(double gain) {
  return gain < 0.0 ? "rose by " + GainText(-gain) : "fell by " + GainText(gain);
}

std::string GainParagraph(const Discovery& discovery) {
  return "Over all channels the mismatch " + Fell(discovery.gain_train) +
         " on what was fitted and " + Fell(discovery.gain_validation) +
         " on unseen data. Of the power that an observer beside the plant fails to "
         "predict, " +
         ShareText(1.0 - discovery.colour_before) + " was white noise before and " +
         ShareText(1.0 - discovery.colour_after) + " is now.";
}

template <typename Plot>
void AddPlots(Page& page, const std::vector<Plot>& plots) {
  for (const Plot& plot : plots) page.AddPlot(plot);
}

void AddMismatch(Page& page, const Discovery& discovery) {
  const Table table = MismatchTable(discovery);
  if (table.rows.empty()) return;
  const bool changed = HasFound(discovery);
  page.AddHeading(changed ? "Mismatch before and after" : "Mismatch");
  page.AddTable(table);
  page.AddParagraph(
      discovery.horizon > 0.0
          ? "No free simulation says anything of this machine. Mismatch is "
            "measured minus what is predicted over " +
                FormatQuantity(discovery.horizon, "s") +
                " from the filtered motion, root mean square; plots show "
                "predictions over a tick. " +
                kFittedAndUnseen
          : kHowToReadMismatch + std::string(kFittedAndUnseen));
  if (changed) page.AddParagraph(GainParagraph(discovery));
  const Table records = RecordTable(discovery);
  if (!records.rows.empty()) {
    page.AddHeading("Every record");
    page.AddTable(records);
  }
  const auto add = [&](const RecordReplay& replay, double fitted) {
    AddPlots(page, MismatchPlots(replay.before, changed ? &replay.after : nullptr,
                                 fitted, kMostChannels));
  };
  if (discovery.Fitted() == nullptr) return;
  add(*discovery.Fitted(), discovery.train_share);
  if (discovery.Unseen() == nullptr) return;
  page.AddHeading("The validation record");
  add(*discovery.Unseen(), 0.0);
}

void AddUnexplained(Page& page, const Discovery& discovery) {
  const std::vector<TimePlot> plots = UnexplainedPlots(discovery);
  if (plots.empty()) return;
  page.AddHeading("Where: the force that the model lacks");
  page.AddParagraph(
      "Estimated from the record at every joint that an actuator drives. Between the "
      "dashed lines it may be an error of the estimate.");
  AddPlots(page, plots);
}

void AddLaws(Page& page, const Discovery& discovery) {
  if (discovery.laws.empty()) return;
  page.AddHeading("Why: the laws that were found");
  page.AddParagraph(
      "Dots: the force that the plant with all other causes does not explain, over "
      "what the cause depends on. Line: the law with the fitted parameters.");
  for (const LawPlot& law : discovery.laws) page.AddPlot(PlotOf(law));
}

/// Unit of what is left at the site of the signature.
std::string UnitOfRest(const Discovery& discovery) {
  for (const DisturbanceEstimate& force : discovery.forces_after) {
    if (force.joint == discovery.unexplained_site) return force.unit;
  }
  return "";
}

void AddResidualDependence(Page& page, const Discovery& discovery) {
  if (!discovery.unexplained) return;
  const ResidualDependence& signature = *discovery.unexplained;
  page.AddHeading("What is left");
  page.AddParagraph(signature.text);
  if (!signature.significant) return;
  std::vector<std::pair<std::string, std::string>> facts = {
      {"Depends on",
       signature.variable +
           (signature.factor.empty() ? "" : " times " + signature.factor)},
      {"Shape", signature.shape},
      {"Explains", ShareText(signature.explained_share) + " of unseen parts"}};
  if (!signature.runner_up.empty()) {
    facts.emplace_back(
        "Next best", signature.runner_up + ", " + ShareText(signature.runner_up_share));
  }
  page.AddFacts(facts);
  if (signature.x.size() > 1)
    page.AddPlot(ResidualDependencePlot(signature, UnitOfRest(discovery)));
}

void AddDecisions(Page& page, const Discovery& discovery) {
  const Table table = DecisionTable(discovery);
  if (table.rows.empty()) return;
  page.AddHeading("What was tried");
  page.AddTable(table);
  page.AddParagraph(
      "In that order, each beside the best model before. The difference is -2 ln of "
      "how "
      "much more probable the record is beside it, with all that it costs: below zero "
      "it "
      "is better.");
}

void AddMinimumDetectableFaults(Page& page, const Discovery& discovery) {
  if (discovery.fault_limits.empty()) return;
  page.AddHeading("What it is for: how small a fault is seen");
  page.AddTable(FaultLimitTable(discovery));
  page.AddParagraph(
      "The smallest change of a fault parameter that the mismatch of this machine does "
      "not hide.");
}

}  // namespace

Page DiscoveryPage(const Discovery& discovery, const DiscoveryRun& run) {
  Page page("What the simulation gets wrong: " + discovery.setup);
  page.SetVerdict(ToneOf(discovery.verdict), DiscoveryAnswer(discovery));
  AddDiscoveryFacts(page, discovery, run);
  AddKinds(page, discovery);
  AddCauses(page, discovery);
  AddCalibration(page, discovery);
  AddNotes(page, discovery);
  AddLadder(page, discovery);
  AddMismatch(page, discovery);
  AddLaws(page, discovery);
  AddResidualDependence(page, discovery);
  AddUnexplained(page, discovery);
  AddMinimumDetectableFaults(page, discovery);
  AddDecisions(page, discovery);
  page.SetRun(run.run);
  return page;
}

}  // namespace mjdiag
