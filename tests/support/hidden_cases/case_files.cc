#include "support/hidden_cases/case_files.h"

#include <nlohmann/json.hpp>

#include "mjdiag/discovery/extension/setup_folder.h"
#include "mjdiag/plugin/plant/plant_number.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json ToJson(const TrueCause& cause) {
  json forms = json::array();
  for (const TrueForm& form : cause.forms) {
    forms.push_back(
        {{"name", form.name}, {"site", form.site}, {"values", form.values}});
  }
  return {{"kinds", cause.kinds},
          {"sites", cause.sites},
          {"forms", forms},
          {"effect", cause.effect}};
}

json TruthOf(const WrittenCase& written, const std::vector<TrueCause>& truth) {
  json causes = json::array();
  for (const TrueCause& cause : truth) causes.push_back(ToJson(cause));
  json numbers = json::object();
  for (const auto& [name, factor] : written.numbers) numbers[name] = factor;
  return {{"schema", "mjdiag.hidden_case/1"},
          {"case", written.hidden.name},
          {"words", written.hidden.words},
          {"seed", written.seed},
          {"causes", causes},
          {"numbers", numbers}};
}

/// A plant whose numbers are off does not say that it is what it says.
void TakeBackThatItIsExact(const fs::path& plant) {
  const std::string claim = R"(<numeric name="known" data="0"/>)";
  std::string text = ReadTextFile(plant);
  const std::size_t at = text.find(claim);
  if (at == std::string::npos) {
    throw InputError(plant.string(), "does not say that it is exact", claim);
  }
  WriteTextFile(plant, text.erase(at, claim.size()));
}

}  // namespace

void WriteCase(const fs::path& folder, const WrittenCase& written,
               const Machine& machine, const std::vector<TrueCause>& truth,
               const Record& record, const Record& unseen) {
  Changes given;
  for (const auto& [name, factor] : written.numbers) {
    given.numbers.emplace_back(FindPlantNumber(machine.plant(), name), 1.0 / factor);
  }
  const fs::path plant = WriteExtendedSetup(folder, written.setup, machine, given);
  if (!written.numbers.empty()) TakeBackThatItIsExact(plant);
  WriteRecord(folder / "record.csv", record, RecordFormat::kCsv);
  WriteRecord(folder / "unseen.csv", unseen, RecordFormat::kCsv);
  WriteTextFile(folder / "truth.json", TruthOf(written, truth).dump(2) + "\n");
}

}  // namespace mjdiag::test
