#include "mjdiag/plugin/plant/fixed_numbers.h"

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

/// "actuator 'valve'", "2 equalities".
std::string Counted(const std::vector<std::string>& names, const std::string& one,
                    const std::string& many) {
  if (names.size() == 1) return one + " '" + names.front() + "'";
  return std::to_string(names.size()) + " " + many;
}

std::vector<std::string> NamesIf(const mjModel& model, mjtObj kind, int count,
                                 const auto& is) {
  std::vector<std::string> names;
  for (int id = 0; id < count; ++id) {
    if (is(id)) names.push_back(ElementName(model, kind, id));
  }
  return names;
}

/// As MuJoCo pairs geoms, without parents and children and what is excluded.
bool MayTouch(const mjModel& model) {
  if (model.npair > 0) return true;
  for (int a = 0; a < model.ngeom; ++a) {
    for (int b = 0; b < a; ++b) {
      const bool match = (model.geom_contype[a] & model.geom_conaffinity[b]) != 0 ||
                         (model.geom_contype[b] & model.geom_conaffinity[a]) != 0;
      const int weld_a = model.body_weldid[model.geom_bodyid[a]];
      const int weld_b = model.body_weldid[model.geom_bodyid[b]];
      if (match && weld_a != weld_b) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> FixedNumbers(const mjModel& model) {
  std::vector<std::string> fixed;
  const auto equalities = NamesIf(model, mjOBJ_EQUALITY, static_cast<int>(model.neq),
                                  [&](int id) { return model.eq_active[id] != 0; });
  if (!equalities.empty()) {
    fixed.push_back("solref and solimp of " +
                    Counted(equalities, "equality", "equalities"));
  }
  const auto springs =
      NamesIf(model, mjOBJ_TENDON, static_cast<int>(model.ntendon),
              [&](int id) { return model.tendon_stiffness[id] != 0.0; });
  if (!springs.empty()) {
    fixed.push_back("springlength of " + Counted(springs, "tendon", "tendons"));
  }
  const auto active =
      NamesIf(model, mjOBJ_ACTUATOR, static_cast<int>(model.nu),
              [&](int id) { return model.actuator_dyntype[id] != mjDYN_NONE; });
  if (!active.empty()) {
    fixed.push_back("dynprm of " + Counted(active, "actuator", "actuators"));
  }
  const auto muscles =
      NamesIf(model, mjOBJ_ACTUATOR, static_cast<int>(model.nu),
              [&](int id) { return model.actuator_gaintype[id] == mjGAIN_MUSCLE; });
  if (!muscles.empty()) {
    fixed.push_back("the curve of " + Counted(muscles, "muscle", "muscles"));
  }
  if (MayTouch(model)) fixed.emplace_back("friction, solref and solimp of contacts");
  return fixed;
}

std::string NoteOfFixedNumbers(const mjModel& model) {
  const std::vector<std::string> fixed = FixedNumbers(model);
  return fixed.empty() ? "" : "never in doubt: " + Listed(fixed);
}

}  // namespace mjdiag
