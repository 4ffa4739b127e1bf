// The residual-based diagnosis, the twin and a data-driven diagnosis on the same runs:
// [AB383], Table 4.

#include <algorithm>
#include <cmath>
#include <random>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/features.h"
#include "mjdiag/studies/svm_classifier.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kHealthy = 0;

struct Case {
  int label = kHealthy;  ///< 0 healthy, else 1 + number of the axis
  PlannedRun run;
};

/// What the two methods need of a run.
struct Sample {
  Eigen::VectorXd features;
  bool detected = false;  ///< by the residual or its spectrum
  int named = kHealthy;   ///< the fault with the most significant estimate
  bool twin_detected = false;
  int twin_named = kHealthy;  ///< by the twin, if it is one alone
};

std::vector<Case> DrawCases(const PlanCase& drawn, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<Case> cases(static_cast<std::size_t>(drawn.points));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i].run.seed = seed + i;
    if (i % 2 == 0) continue;
    const std::size_t kind = (i / 2) % drawn.axes.size();
    const PlanAxis& axis = drawn.axes[kind];
    const auto [from, to] = axis.ranges.front();
    const double first = std::log(std::abs(from - axis.healthy));
    const double last = std::log(std::abs(to - axis.healthy));
    const double size = std::exp(first + (last - first) * uniform(generator));
    cases[i].label = 1 + static_cast<int>(kind);
    cases[i].run.axes = {
        {&axis, axis.healthy + std::copysign(size, from - axis.healthy)}};
  }
  return cases;
}

/// The fault that deviates most in its own standard deviations.
int MostSignificant(const DiagnosisResult& result, const std::vector<PlanAxis>& kinds) {
  int named = kHealthy;
  double most = 0.0;
  for (const FaultVerdict& fault : result.faults) {
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      if (kinds[i].name != fault.name) continue;
      const double significance = std::abs(fault.deviation) / fault.sd;
      if (significance > most) {
        most = significance;
        named = 1 + static_cast<int>(i);
      }
    }
  }
  return named;
}

/// The fault that the twin names, if it names one.
int NamedAlone(const TwinReading& reading, const std::vector<std::string>& names,
               const std::vector<PlanAxis>& kinds) {
  if (std::ranges::count(reading.named, true) != 1) return kHealthy;
  const auto at = std::ranges::find(reading.named, true) - reading.named.begin();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i].name == names[static_cast<std::size_t>(at)]) {
      return 1 + static_cast<int>(i);
    }
  }
  return kHealthy;
}

std::vector<Sample> RunCases(const LoadedPlan& loaded,
                             const std::vector<PlanAxis>& kinds,
                             const std::vector<Case>& cases,
                             const StudyOptions& options) {
  const StudyPlan& plan = loaded.plan;
  const Machine& machine = loaded.machine;
  const RunMaker maker(loaded);
  const DiagnosisDesign design = DiagnosisOn(machine, plan.linear).design;
  std::vector<std::string> channels = design.outputs;
  channels.insert(channels.end(), design.inputs.begin(), design.inputs.end());
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();

  std::vector<Sample> samples(cases.size());
  ParallelFor(
      static_cast<int>(cases.size()),
      [&](int i) {
        const Record record = maker.Simulate(cases[static_cast<std::size_t>(i)].run);
        const DiagnosisResult result = Conclude(RecordDiagnosis(design, record));
        const TwinReading reading = Listen(machine, record, plan.linear);
        samples[static_cast<std::size_t>(i)] = {
            Features(record, channels),
            result.first_detection.has_value() || result.disturbance.disturbed,
            MostSignificant(result, kinds),
            std::ranges::any_of(reading.named, [](bool named) { return named; }),
            NamedAlone(reading, names, kinds)};
      },
      options.progress);
  return samples;
}

/// Rows and labels of the cases that `chosen` picks.
template <typename Predicate>
std::pair<MatrixXd, std::vector<int>> Select(const std::vector<Case>& cases,
                                             const std::vector<Sample>& samples,
                                             const Predicate& chosen) {
  std::vector<int> labels;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (!chosen(i)) continue;
    rows.push_back(i);
    labels.push_back(cases[i].label);
  }
  MatrixXd features(static_cast<Index>(rows.size()), samples.front().features.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    features.row(static_cast<Index>(i)) = samples[rows[i]].features;
  }
  return {features, labels};
}

std::vector<int> FaultyOrNot(std::vector<int> labels) {
  for (int& label : labels) label = label == kHealthy ? 0 : 1;
  return labels;
}

std::vector<Cell> Row(const std::string& method, const Confusion& detection,
                      const Confusion& isolation) {
  return {method, 100.0 * detection.accuracy(),
          100.0 * detection.false_alarm_rate(kHealthy),
          100.0 * detection.missed_detection_rate(kHealthy),
          100.0 * isolation.accuracy()};
}

std::vector<StudyTable> Classify(const LoadedPlan& loaded, const PlanCase& drawn,
                                 const StudyOptions& options) {
  RequireFaults(drawn, AxisValues::kDrawn);
  const std::vector<Case> cases = DrawCases(drawn, loaded.plan.seed);
  const std::vector<Sample> samples = RunCases(loaded, drawn.axes, cases, options);
  // Pairs of a healthy and a faulty run go to training and test in turn, a round of all
  // faults at a time.
  const std::size_t round = 2 * drawn.axes.size();
  const auto in_training = [&](std::size_t i) { return (i / round) % 2 == 0; };
  const auto in_test = [&](std::size_t i) { return !in_training(i); };
  const auto faulty = [&](std::size_t i) { return cases[i].label != kHealthy; };

  const auto [train, train_labels] = Select(cases, samples, in_training);
  const auto [test, test_labels] = Select(cases, samples, in_test);
  const auto [faulty_train, faulty_train_labels] = Select(
      cases, samples, [&](std::size_t i) { return in_training(i) && faulty(i); });
  const auto [faulty_test, faulty_test_labels] =
      Select(cases, samples, [&](std::size_t i) { return in_test(i) && faulty(i); });

  const SvmClassifier detector = SvmClassifier::Train(train, FaultyOrNot(train_labels));
  const SvmClassifier isolator =
      SvmClassifier::Train(faulty_train, faulty_train_labels);
  std::vector<int> detected;
  std::vector<int> named;
  std::vector<int> twin_detected;
  std::vector<int> twin_named;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (!in_test(i)) continue;
    detected.push_back(samples[i].detected ? 1 : 0);
    twin_detected.push_back(samples[i].twin_detected ? 1 : 0);
    if (!faulty(i)) continue;
    named.push_back(samples[i].named);
    twin_named.push_back(samples[i].twin_named);
  }
  const std::vector<int> truth = FaultyOrNot(test_labels);
  StudyTable table{
      "Residual-based and data-driven diagnosis on the same runs, " + drawn.name,
      {"method", "detection [%]", "false alarms [%]", "missed [%]", "isolation [%]"},
      {},
      {std::to_string(train.rows()) +
           " runs trained the support vector "
           "machines, " +
           std::to_string(test.rows()) + " others are judged here.",
       "Isolation is counted over faulty runs; the twin has to name the one fault "
       "alone."}};
  table.rows.push_back(Row("residuals", CountConfusion(truth, detected),
                           CountConfusion(faulty_test_labels, named)));
  table.rows.push_back(Row("twin", CountConfusion(truth, twin_detected),
                           CountConfusion(faulty_test_labels, twin_named)));
  table.rows.push_back(
      Row("support vector machine", CountConfusion(truth, detector.PredictRows(test)),
          CountConfusion(faulty_test_labels, isolator.PredictRows(faulty_test))));

  StudyTable sizes{
      "Ranges of the faults, " + drawn.name, {"fault", "from", "to"}, {}, {}};
  for (const PlanAxis& axis : drawn.axes) {
    sizes.rows.push_back({axis.name, axis.ranges.front().from, axis.ranges.front().to});
  }
  return {table, sizes};
}

}  // namespace

std::vector<StudyTable> AnswerTo(const AskClasses&, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const std::vector<PlanCase>& cases = loaded.plan.cases;
  std::vector<StudyTable> tables;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (StudyTable& table :
         Classify(loaded, cases[i], options.PartOf(i, cases.size()))) {
      tables.push_back(std::move(table));
      if (options.row) options.row(tables.back());
    }
  }
  return tables;
}

}  // namespace mjdiag
