#include "mjdiag/studies/classification_study.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/features.h"
#include "mjdiag/studies/svm_classifier.h"
#include "mjdiag/studies/twin_listening.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kHealthy = 0;

struct Case {
  int label = kHealthy;  ///< 0 healthy, else 1 + number of the fault
  std::vector<SizedFault> faults;
};

/// What the two methods need of a run.
struct Sample {
  Eigen::VectorXd features;
  bool detected = false;  ///< by the residual or its spectrum
  int named = kHealthy;   ///< the fault with the most significant estimate
  bool twin_detected = false;
  int twin_named = kHealthy;  ///< by the twin, if it is one alone
};

/// What may be wrong: [studies.<from>] and [studies.<to>].
struct Ranges {
  std::string title;
  const std::vector<std::pair<std::string, double>>& from;
  const std::vector<std::pair<std::string, double>>& to;
};

Ranges RangesOf(const Setup& setup, const std::string& title, const std::string& name) {
  const auto& from = setup.Study(name + "_from").values;
  const auto& to = setup.Study(name + "_to").values;
  const auto same_name = [](const auto& a, const auto& b) {
    return a.first == b.first;
  };
  if (!std::equal(from.begin(), from.end(), to.begin(), to.end(), same_name)) {
    throw InputError("studies." + name + "_to", "other faults than " + name + "_from",
                     "the same in the same order");
  }
  return {title, from, to};
}

std::vector<Case> DrawCases(const Setup& setup, const Ranges& ranges, int runs,
                            std::uint64_t seed) {
  const auto& [title, from, to] = ranges;
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform;
  const auto kinds = static_cast<int>(from.size());
  std::vector<Case> cases;
  for (int i = 0; i < runs; ++i) {
    if (i % 2 == 0) {
      cases.push_back({});
      continue;
    }
    const int kind = (i / 2) % kinds;
    const auto& [name, low] = from[static_cast<std::size_t>(kind)];
    const double healthy = HealthyValue(setup, name);
    const double first = std::log(std::abs(low - healthy));
    const double last =
        std::log(std::abs(to[static_cast<std::size_t>(kind)].second - healthy));
    const double size = std::exp(first + (last - first) * uniform(generator));
    cases.push_back({1 + kind, {{name, healthy + std::copysign(size, low - healthy)}}});
  }
  return cases;
}

/// The fault that deviates most in its own standard deviations.
int MostSignificant(const DiagnosisResult& result,
                    const std::vector<std::pair<std::string, double>>& kinds) {
  int named = kHealthy;
  double most = 0.0;
  for (const FaultVerdict& fault : result.faults) {
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      if (kinds[i].first != fault.name) continue;
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
               const std::vector<std::pair<std::string, double>>& kinds) {
  if (std::ranges::count(reading.named, true) != 1) return kHealthy;
  const auto at = std::ranges::find(reading.named, true) - reading.named.begin();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i].first == names[static_cast<std::size_t>(at)]) {
      return 1 + static_cast<int>(i);
    }
  }
  return kHealthy;
}

std::vector<Sample> RunCases(const Machine& machine, const Ranges& ranges,
                             const std::vector<Case>& cases,
                             const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  const DiagnosisDesign design = LinearDiagnosis(machine).design;
  std::vector<std::string> channels = design.outputs;
  channels.insert(channels.end(), design.inputs.begin(), design.inputs.end());
  const auto& kinds = ranges.from;
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();

  std::vector<Sample> samples(cases.size());
  ParallelFor(
      static_cast<int>(cases.size()),
      [&](int i) {
        const Case& drawn = cases[static_cast<std::size_t>(i)];
        const Record record =
            RunLinear(motion, WithFaults(machine, drawn.faults,
                                         options.seed + static_cast<std::uint64_t>(i)));
        const DiagnosisResult result = Conclude(RecordDiagnosis(design, record));
        const TwinReading reading = Listen(machine, record, true);
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

std::vector<StudyTable> Classify(const Machine& machine, const Ranges& ranges,
                                 const StudyOptions& options) {
  const std::vector<Case> cases =
      DrawCases(machine.setup(), ranges, options.runs, options.seed);
  const std::vector<Sample> samples = RunCases(machine, ranges, cases, options);
  // Pairs of a healthy and a faulty run go to training and test in turn, a round of all
  // faults at a time.
  const std::size_t round = 2 * ranges.from.size();
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
      "Residual-based and data-driven diagnosis on the same runs, " + ranges.title,
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
      "Ranges of the faults, " + ranges.title, {"fault", "from", "to"}, {}, {}};
  for (std::size_t i = 0; i < ranges.from.size(); ++i) {
    sizes.rows.push_back(
        {ranges.from[i].first, ranges.from[i].second, ranges.to[i].second});
  }
  return {table, sizes};
}

}  // namespace

std::vector<StudyTable> ClassificationStudy(const Machine& machine,
                                            const StudyOptions& options) {
  const Setup& setup = machine.setup();
  const std::vector<Ranges> cases = {
      RangesOf(setup, "per cent of the largest force", "table4"),
      RangesOf(setup, "gamma as printed", "table4_printed")};
  std::vector<StudyTable> tables;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    StudyOptions part = options;
    part.progress = [&, i](double fraction) {
      if (!options.progress) return;
      options.progress((static_cast<double>(i) + fraction) /
                       static_cast<double>(cases.size()));
    };
    for (StudyTable& table : Classify(machine, cases[i], part)) {
      tables.push_back(std::move(table));
      if (options.row) options.row(tables.back());
    }
  }
  return tables;
}

}  // namespace mjdiag
