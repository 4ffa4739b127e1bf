#include "mjdiag/discovery/measurements.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

std::vector<std::string> NamesOf(const mjModel& model, mjtObj kind, int count) {
  std::vector<std::string> names;
  for (int id = 0; id < count; ++id) names.push_back(ElementName(model, kind, id));
  return names;
}

/// Loads differ, not machines: what is found of one holds for the other.
void RequireSameElements(const std::string& file, const mjModel& plant,
                         const mjModel& nominal) {
  const auto require = [&](mjtObj kind, int count, int nominal_count) {
    if (NamesOf(plant, kind, count) == NamesOf(nominal, kind, nominal_count)) return;
    throw InputError(file,
                     std::string("has other ") + mju_type2Str(kind) + "s than '" +
                         nominal.names + "'",
                     "the joints, actuators and sensors of the setup's plant, in the "
                     "same order");
  };
  require(mjOBJ_JOINT, plant.njnt, nominal.njnt);
  require(mjOBJ_ACTUATOR, plant.nu, nominal.nu);
  require(mjOBJ_SENSOR, plant.nsensor, nominal.nsensor);
  const std::span types(plant.jnt_type, static_cast<std::size_t>(plant.njnt));
  if (std::ranges::equal(types, std::span(nominal.jnt_type, types.size()))) return;
  throw InputError(file, "has joints of other types", "those of the setup's plant");
}

/// With what the plant of a record has of its own.
Machine WithOwnNumbers(const ManifestRecord& record, const Machine& during) {
  NumberFactors factors;
  for (const auto& [name, value] : record.numbers) {
    try {
      const ModelParameter number = FindModelParameter(during.plant(), name);
      factors.emplace_back(number, FactorFor(during.plant(), number, value));
    } catch (const InputError& error) {
      throw InputError("numbers of " + record.file.filename().string() + ": " +
                       error.what());
    }
  }
  return factors.empty() ? during : during.WithNumbers(factors);
}

Machine MachineDuring(const ManifestRecord& record, const Machine& nominal,
                      const std::filesystem::path& setup,
                      std::vector<std::string> overrides) {
  if (record.plant.empty()) {
    return record.overrides.empty() ? nominal
                                    : nominal.WithSetup(ReadSetup(setup, overrides));
  }
  overrides.push_back("plant=\"" + record.plant + "\"");
  const Machine loaded(ReadSetup(setup, overrides));
  RequireSameElements(record.plant, loaded.plant(), nominal.plant());
  return loaded.With(nominal.changes());
}

}  // namespace

Measurements ReadMeasurements(const Machine& nominal,
                              const std::filesystem::path& setup,
                              const std::vector<std::string>& overrides,
                              const std::vector<ManifestRecord>& records) {
  Measurements measurements;
  for (const ManifestRecord& one : records) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), one.overrides.begin(), one.overrides.end());
    const Machine during = WithOwnNumbers(one, MachineDuring(one, nominal, setup, all));
    MeasuredFile measured = ReadMeasured(during.setup(), one.file);
    (one.fit ? measurements.fit : measurements.unseen)
        .push_back({std::move(measured.record), during, one.file.filename().string(),
                    std::move(measured.notes),
                    !one.plant.empty() || !one.numbers.empty()});
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

MeasuredRun RunOf(const std::vector<MeasuredRecord>& records) {
  std::vector<MeasuredRun> runs;
  for (const MeasuredRecord& one : records) {
    runs.push_back(ToMeasuredRun(one.machine.setup(), one.record));
    if (one.own_plant) {
      runs.back().records.front().machine =
          std::make_shared<const Machine>(one.machine);
    }
  }
  return Joined(runs);
}

}  // namespace mjdiag
