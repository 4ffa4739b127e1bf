#include "mjdiag/plugin/setup/diagnosis_reader.h"

#include <algorithm>

namespace mjdiag {
namespace {

constexpr int kHighestDegree = 40;
constexpr int kHighestOrder = 20;
constexpr int kHighestHighPass = 12;
constexpr NumberRule kMargin{[](double x) { return x >= 1.0; }, "a number >= 1"};
constexpr NumberRule kProbability{[](double x) { return x >= 0.0 && x < 1.0; },
                                  "a number >= 0 and < 1"};

double Cutoff(const TomlTable& table, const Setup& setup, double fallback) {
  const double cutoff = table.Number("cutoff", kPositive, fallback);
  if (cutoff >= 0.5 * setup.rates.control) {
    table.Fail("cutoff", "is " + std::to_string(cutoff) + " Hz",
               "less than half the control rate");
  }
  return cutoff;
}

void ReadOrder(const TomlTable& table, const Setup& setup, ResidualOrder& residual) {
  residual.degree = table.Integer("degree", 1, kHighestDegree, residual.degree);
  Denominator& denominator = residual.denominator;
  denominator.order = table.Integer("order", 1, kHighestOrder, denominator.order);
  denominator.cutoff = Cutoff(table, setup, denominator.cutoff);
}

void ReadThresholds(const TomlTable& table, const Setup& setup,
                    DiagnosisOptions& options) {
  options.margin = table.Number("margin", kMargin, options.margin);
  options.false_alarms = table.Number("false_alarms", kProbability, 0.0);
  options.integral_window =
      table.Number("integral_window", kPositive, options.integral_window);
  options.trajectories = table.Texts("trajectories", {});
  for (const std::string& name : options.trajectories) {
    const auto named = [&](const Trajectory& t) { return t.name == name; };
    if (!std::any_of(setup.trajectories.all.begin(), setup.trajectories.all.end(),
                     named)) {
      table.Fail("trajectories", "there is no trajectory '" + name + "'",
                 "names under [trajectories]");
    }
  }
}

void ReadEstimation(const TomlTable& table, DiagnosisOptions& options) {
  options.estimation_residuals =
      table.Integer("rows", 0, 100, options.estimation_residuals);
  options.sampling = table.Number("sampling", kPositive, options.sampling);
  options.horizon = table.Number("horizon", kNonNegative, options.horizon);
  options.forgetting = table.Number("forgetting", kNonNegative, options.forgetting);
  if (!table.Has("magnitudes")) return;
  for (const auto& [name, magnitude] :
       table.NamedNumbers("magnitudes", "<fault>", kPositive)) {
    options.magnitudes[name] = magnitude;
  }
}

void ReadDisturbance(const TomlTable& table, const Setup& setup,
                     DiagnosisOptions& options) {
  Denominator& denominator = options.disturbance_denominator;
  denominator.order = table.Integer("order", 1, kHighestOrder, denominator.order);
  denominator.cutoff = Cutoff(table, setup, denominator.cutoff);
  if (const auto high_pass = table.FindTable("high_pass")) {
    options.high_pass_order =
        high_pass->Integer("order", 1, kHighestHighPass, options.high_pass_order);
    options.high_pass_cutoff = Cutoff(*high_pass, setup, options.high_pass_cutoff);
  }
  DisturbanceOptions& spectrum = options.disturbance;
  spectrum.segment =
      table.Integer("segment", 64, 1'000'000, static_cast<int>(spectrum.segment));
  spectrum.peak_margin =
      table.Number("peak_margin", kNonNegative, spectrum.peak_margin);
  spectrum.total_margin =
      table.Number("total_margin", kNonNegative, spectrum.total_margin);
  spectrum.tone_false_alarm =
      table.Number("tone_false_alarm", kShare, spectrum.tone_false_alarm);
}

void ReadRobust(const TomlTable& table, const Setup& setup, RobustOptions& robust) {
  ReadOrder(table, setup, robust.residual);
  robust.runs = table.Integer("runs", 2, 1000, robust.runs);
}

}  // namespace

DiagnosisOptions ReadDiagnosis(const TomlTable& table, const Setup& setup) {
  DiagnosisOptions options;
  ReadOrder(table, setup, options.residual);
  options.unknown_forces = table.Texts("unknown_forces", {});
  if (const auto thresholds = table.FindTable("thresholds")) {
    ReadThresholds(*thresholds, setup, options);
  }
  if (const auto estimation = table.FindTable("estimation")) {
    ReadEstimation(*estimation, options);
  }
  if (const auto disturbance = table.FindTable("disturbance")) {
    ReadDisturbance(*disturbance, setup, options);
  }
  if (const auto robust = table.FindTable("robust")) {
    ReadRobust(*robust, setup, options.robust);
  }
  return options;
}

}  // namespace mjdiag
