#include "app/study_answer.h"

#include <utility>
#include <vector>

#include "app/command.h"
#include "app/study_log.h"
#include "mjdiag/report/study_page.h"
#include "mjdiag/studies/answer.h"

namespace mjdiag::app {
namespace {

NamedPage AnswerPage(const LoadedPlan& loaded, const AnswerLabel& label,
                     const std::vector<StudyTable>& tables) {
  StudyFacts facts{loaded.machine.setup().name, label.name, label.runs,
                   loaded.plan.seed};
  facts.is_plan = std::string(label.kind) == "plan";
  const RunDescription run{CommandLine(), "", {{"mjdiag", MJDIAG_VERSION}}};
  return {"study", StudyPage(facts, tables, run)};
}

}  // namespace

void AnswerPlan(const LoadedPlan& loaded, const AnswerLabel& label,
                const OutputOptions& output) {
  PrepareOutput(output);
  StudyLog log(output,
               {{"schema", "mjdiag.study/1"},
                {"setup", loaded.machine.setup().name},
                {label.kind, label.name},
                {"runs", label.runs},
                {"seed", loaded.plan.seed},
                {"linear", label.linear},
                {"command", CommandLine()}},
               "study " + label.name);
  StudyOptions options;
  options.progress = [&log](double fraction) { log.Progress(fraction); };
  options.row = [&log](const StudyTable& table) { log.Show(table); };
  const std::vector<StudyTable> tables = AnswerTo(loaded, options);
  Publish(output, "study", log.Document(tables, true), log.RestOf(tables),
          [&] { return AnswerPage(loaded, label, tables); });
}

}  // namespace mjdiag::app
