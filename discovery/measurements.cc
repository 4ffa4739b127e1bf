#include "mjdiag/discovery/measurements.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "mjdiag/plugin/setup/measured_file.h"

namespace mjdiag {

Measurements ReadMeasurements(const Machine& nominal,
                              const std::filesystem::path& setup,
                              const std::vector<std::string>& overrides,
                              const std::vector<ManifestRecord>& records) {
  Measurements measurements;
  for (const ManifestRecord& one : records) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), one.overrides.begin(), one.overrides.end());
    const Machine during =
        one.overrides.empty() ? nominal : nominal.WithSetup(ReadSetup(setup, all));
    MeasuredFile measured = ReadMeasured(during.setup(), one.file);
    (one.fit ? measurements.fit : measurements.unseen)
        .push_back({std::move(measured.record), during, one.file.filename().string(),
                    std::move(measured.notes)});
  }
  return measurements;
}

Measurements MeasurementsOf(const Machine& machine, const Record& measured,
                            const Record* unseen) {
  const auto made = [&](const Record& record) {
    MeasuredFile file = WithoutRepeats(record, ReadingsOf(machine.setup()));
    return MeasuredRecord{std::move(file.record), machine, "", std::move(file.notes)};
  };
  Measurements measurements;
  measurements.fit.push_back(made(measured));
  if (unseen != nullptr) measurements.unseen.push_back(made(*unseen));
  return measurements;
}

Measurements WithUnseen(Measurements measurements, double fit_share) {
  std::vector<MeasuredRecord>& fit = measurements.fit;
  if (!measurements.unseen.empty() || fit.size() < 2) return measurements;
  const auto records = static_cast<double>(fit.size());
  const auto kept = std::clamp<std::ptrdiff_t>(std::lround(fit_share * records), 1,
                                               std::ssize(fit) - 1);
  measurements.unseen.assign(std::make_move_iterator(fit.begin() + kept),
                             std::make_move_iterator(fit.end()));
  fit.erase(fit.begin() + kept, fit.end());
  return measurements;
}

MeasuredRun RunOf(const std::vector<MeasuredRecord>& records) {
  std::vector<MeasuredRun> runs;
  for (const MeasuredRecord& one : records) {
    runs.push_back(ToMeasuredRun(one.machine.setup(), one.record));
  }
  return Joined(runs);
}

}  // namespace mjdiag
