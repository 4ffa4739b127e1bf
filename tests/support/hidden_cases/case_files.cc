#include "support/hidden_cases/case_files.h"

#include <nlohmann/json.hpp>

#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json ToJson(const std::vector<TrueForm>& forms) {
  json array = json::array();
  for (const TrueForm& form : forms) {
    array.push_back(
        {{"name", form.name}, {"site", form.site}, {"values", form.values}});
  }
  return array;
}

json ToJson(const TrueCause& cause) {
  return {{"kinds", cause.kinds},
          {"sites", cause.sites},
          {"forms", ToJson(cause.forms)},
          {"effect", cause.effect}};
}

/// A number of the plant may be said as the fault that scales it and nothing else, a damping as
/// the viscous friction that there is more of.
std::vector<TrueForm> FormsOf(const mjModel& plant, const std::string& number,
                              double factor) {
  std::vector<TrueForm> forms;
  for (const FaultParameter& fault : FaultParameters(plant)) {
    if (fault.elements.size() != 1) continue;
    const ModelParameter own{fault.kind, fault.elements[0]};
    if (ModelParameterName(plant, own) == number)
      forms.push_back({fault.name, "", {{"factor", factor}}});
  }
  const ModelParameter own = FindModelParameter(plant, number);
  if (own.kind == ModelParameterKind::kDamping) {
    const double more =
        (1.0 - 1.0 / factor) * plant.dof_damping[plant.jnt_dofadr[own.element]];
    forms.push_back({"viscous_friction",
                     ElementName(plant, mjOBJ_JOINT, own.element),
                     {{"coefficient", more}}});
  }
  return forms;
}

/// Where a number may be said to be: its element, and the joints of a body.
std::vector<std::string> PlacesOf(const mjModel& plant, const std::string& number) {
  std::vector<std::string> places = {number.substr(number.find('@') + 1)};
  const int body = mj_name2id(&plant, mjOBJ_BODY, places[0].c_str());
  for (int j = 0; body > 0 && j < plant.njnt; ++j) {
    if (plant.jnt_bodyid[j] == body)
      places.push_back(ElementName(plant, mjOBJ_JOINT, j));
  }
  return places;
}

json ToJson(const CaseTruth& truth, const Machine& machine) {
  json causes = json::array();
  for (const TrueCause& cause : truth.causes) causes.push_back(ToJson(cause));
  json numbers = json::object();
  for (const auto& [name, factor] : truth.numbers) {
    numbers[name] = {{"factor", factor},
                     {"sites", PlacesOf(machine.plant(), name)},
                     {"forms", ToJson(FormsOf(machine.plant(), name, factor))}};
  }
  return {{"schema", "mjdiag.hidden_case/1"},
          {"case", truth.hidden.name},
          {"words", truth.hidden.words},
          {"seed", truth.seed},
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

void WriteGivenSetup(const fs::path& folder, const fs::path& setup,
                     const Machine& machine, const NamedFactors& numbers) {
  Changes given;
  for (const auto& [name, factor] : numbers) {
    given.numbers.emplace_back(FindModelParameter(machine.plant(), name), 1.0 / factor);
  }
  const fs::path plant = WriteExtendedSetup(folder, setup, machine, given);
  if (!numbers.empty()) TakeBackThatItIsExact(plant);
}

void WriteCase(const fs::path& folder, const CaseTruth& truth, const Machine& machine,
               const Record& record, const Record& unseen) {
  WriteRecord(folder / "record.csv", record, RecordFormat::kCsv);
  WriteRecord(folder / "unseen.csv", unseen, RecordFormat::kCsv);
  WriteTextFile(folder / "truth.json", ToJson(truth, machine).dump(2) + "\n");
}

}  // namespace mjdiag::test
