#include "mjdiag/plugin/plant/model_parameter_kind.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

namespace mjdiag {
namespace {

struct KindOfNumber {
  ModelParameterKind kind;
  std::string_view word;
  mjtObj element;
  std::string_view meaning;
  double spread;  ///< UsualSpread
  double doubt;   ///< UsualDoubt
};

constexpr double kFactorOfTwo = std::numbers::ln2;

using enum ModelParameterKind;

/// In the order of ModelParameterKind.
constexpr auto kKinds = std::to_array<KindOfNumber>({
    {kMass, "mass", mjOBJ_BODY, "mass", 0.01, 0.05},
    {kInertia, "inertia", mjOBJ_BODY, "inertia", 0.03, 0.1},
    {kStiffness, "stiffness", mjOBJ_JOINT, "stiffness", 0.05, 0.1},
    {kDamping, "damping", mjOBJ_JOINT, "damping", 0.2, kFactorOfTwo},
    {kFriction, "friction", mjOBJ_JOINT, "dry friction", 0.2, kFactorOfTwo},
    {kGear, "gear", mjOBJ_ACTUATOR, "force", 0.01, 0.05},
    {kArmature, "armature", mjOBJ_JOINT, "rotor inertia", 0.05, 0.1},
    {kGain, "gain", mjOBJ_ACTUATOR, "gain", 0.03, 0.1},
    {kCentreX, "centre_x", mjOBJ_BODY, "centre of mass", 0.03, 0.1},
    {kCentreY, "centre_y", mjOBJ_BODY, "centre of mass", 0.03, 0.1},
    {kCentreZ, "centre_z", mjOBJ_BODY, "centre of mass", 0.03, 0.1},
    {kKp, "kp", mjOBJ_ACTUATOR, "position gain", 0.01, 0.2},
    {kKv, "kv", mjOBJ_ACTUATOR, "velocity gain", 0.05, 0.2},
    {kTendonStiffness, "tendon_stiffness", mjOBJ_TENDON, "stiffness", 0.05, 0.1},
    {kTendonDamping, "tendon_damping", mjOBJ_TENDON, "damping", 0.2, kFactorOfTwo},
    {kTendonFriction, "tendon_friction", mjOBJ_TENDON, "dry friction", 0.2,
     kFactorOfTwo},
    {kRef, "ref", mjOBJ_JOINT, "reference", 2e-4, 5e-3},
});

consteval bool IsInOrder() {
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (static_cast<std::size_t>(kKinds[i].kind) != i) return false;
  }
  return true;
}
static_assert(IsInOrder());

const KindOfNumber& Of(ModelParameterKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

/// "a, b or c".
std::string Alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace

std::string_view WordOf(ModelParameterKind kind) { return Of(kind).word; }

std::optional<ModelParameterKind> FindKind(std::string_view word) {
  const auto found = std::ranges::find(kKinds, word, &KindOfNumber::word);
  if (found == kKinds.end()) return std::nullopt;
  return found->kind;
}

mjtObj ElementOf(ModelParameterKind kind) { return Of(kind).element; }

std::string_view MeaningOf(ModelParameterKind kind) { return Of(kind).meaning; }

std::string AllKinds(bool additive) {
  std::string text;
  for (const mjtObj element : {mjOBJ_BODY, mjOBJ_JOINT, mjOBJ_ACTUATOR, mjOBJ_TENDON}) {
    std::vector<std::string> words;
    for (const KindOfNumber& kind : kKinds) {
      if (kind.element != element || (!additive && IsAdditive(kind.kind))) continue;
      words.push_back(std::string(kind.word) + "@");
    }
    const std::string_view article = element == mjOBJ_ACTUATOR ? " an " : " a ";
    text.append(text.empty() ? "" : ", ").append(Alternatives(words)).append(article);
    text += mju_type2Str(element);
  }
  return text;
}

bool IsAdditive(ModelParameterKind kind) { return IsCentre(kind) || kind == kRef; }

bool IsCentre(ModelParameterKind kind) {
  return kind == kCentreX || kind == kCentreY || kind == kCentreZ;
}

bool IsFriction(ModelParameterKind kind) {
  return kind == kFriction || kind == kTendonFriction;
}

bool IsDrive(ModelParameterKind kind) { return Of(kind).element == mjOBJ_ACTUATOR; }

bool IsDerivedFrom(ModelParameterKind kind) {
  return Of(kind).element == mjOBJ_BODY || kind == kArmature || kind == kRef;
}

double UsualSpread(ModelParameterKind kind) { return Of(kind).spread; }

double UsualDoubt(ModelParameterKind kind) { return Of(kind).doubt; }

}  // namespace mjdiag
