#include "mjdiag/plugin/draft/log_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/median.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// What MuJoCo models are logged at.
constexpr double kSlowest = 5.0;    // [Hz]
constexpr double kFastest = 20e3;   // [Hz]
constexpr double kMostSteps = 0.1;  // of a time that may go back or stand still

constexpr std::array<std::pair<const char*, double>, 4> kUnits{
    {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};

/// Usual step of a column that grows; none of one that does not.
std::optional<double> StepOf(const Eigen::VectorXd& times) {
  std::vector<double> steps;
  double before = NAN;
  Index wrong = 0;
  for (const double time : times) {
    if (!std::isfinite(time)) continue;
    if (std::isfinite(before)) {
      time > before ? steps.push_back(time - before) : void(++wrong);
    }
    before = time;
  }
  if (steps.empty() ||
      static_cast<double>(wrong) > kMostSteps * static_cast<double>(times.size())) {
    return std::nullopt;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

bool IsPlausible(double interval) {
  return interval >= 1.0 / kFastest && interval <= 1.0 / kSlowest;
}

void ChooseUnit(double step, LogColumns& log) {
  ColumnWords& time = *log.time;
  std::vector<std::string> plausible;
  for (const auto& [unit, factor] : kUnits) {
    if (IsPlausible(step * factor)) plausible.emplace_back(unit);
  }
  // Numbers with a point are seconds if they can be.
  const bool whole = std::abs(step - std::round(step)) < 1e-9 * step;
  if (!plausible.empty() && plausible.front() == "s" && !whole) plausible.resize(1);
  if (plausible.size() != 1) {
    const std::string given = plausible.empty() ? "s, ms, us or ns" : Listed(plausible);
    log.questions.push_back("time '" + time.name + "' has no unit: write " + given +
                            " under record.time.unit");
  }
  time.unit = plausible.empty() ? "s" : plausible.front();
  if (plausible.size() == 1) {
    log.assumed.push_back("time '" + time.name + "' is in " + *time.unit);
  }
}

void ChooseTime(RecordSource& source, std::vector<ColumnWords>& all,
                std::vector<std::size_t>& places, LogColumns& log) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].quantity != Quantity::kTime || all[i].role == ColumnRole::kOther ||
        !all[i].unknown_unit.empty()) {
      continue;
    }
    const std::array<std::size_t, 1> chosen{places[i]};
    std::optional<double> step;
    try {
      step = StepOf(source.Read(chosen, MissingCells::kNan).front());
    } catch (const InputError&) {
      continue;  // texts: of a date, for example
    }
    if (!step) continue;
    log.time = all[i];
    if (!log.time->unit) ChooseUnit(*step, log);
    log.interval = *step * ParseUnit(*log.time->unit).factor;
    return;
  }
  log.questions.push_back(
      "no column is a time: give the log one, called time, and its unit");
}

}  // namespace

LogColumns ReadLogColumns(const std::filesystem::path& file) {
  const std::unique_ptr<RecordSource> source = OpenRecordSource(file);
  LogColumns log;
  log.file = file;
  std::vector<ColumnWords> all;
  std::vector<std::size_t> places;
  const std::vector<SourceColumn>& columns = source->columns();
  Index longest = 0;
  for (const SourceColumn& column : columns) {
    longest = std::max(longest, column.samples.value_or(0));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    // Gains and texts beside the series.
    if (columns[i].name.empty()) continue;
    if (columns[i].samples && 2 * *columns[i].samples <= longest) continue;
    all.push_back(ReadColumnWords(columns[i]));
    places.push_back(i);
  }
  ChooseTime(*source, all, places, log);
  for (ColumnWords& column : all) {
    if (column.quantity != Quantity::kTime) log.columns.push_back(std::move(column));
  }
  return log;
}

std::optional<Record> RawColumns(const LogColumns& log,
                                 const std::vector<std::string>& columns) {
  if (!log.time || columns.empty() || !(log.interval > 0.0)) return std::nullopt;
  ColumnMap map;
  map.time = {"time", log.time->name, *log.time->unit, false};
  for (const std::string& name : columns) map.columns.push_back({name, name, "1"});
  try {
    return ReadMeasuredFile(log.file, map, {log.interval, {}, {}}).record;
  } catch (const InputError&) {
    return std::nullopt;  // whoever uses the setup is told what is wrong with the file
  }
}

}  // namespace mjdiag
