// What holds for every effect of the catalogue.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>

#include "effect_bench.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/bonder.h"
#include "support/message_of.h"

// Counts operator new, through which containers allocate. (malloc itself is already
// replaced in this test program, by count_allocations.h.) Not inlined: GCC would take a
// malloc that it sees for the partner of a delete that it does not.
namespace {
long allocations = 0;
}  // namespace
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

/// The effect with a value inside the bounds for each parameter, all of them with many
/// digits.
EffectSpec Example(const EffectType& type, const std::string& site) {
  EffectSpec spec{type.name, site, {}};
  double value = 1.0 / 3.0;
  for (const EffectParameter& parameter : type.parameters) {
    value *= 0.7;
    spec.parameters[parameter.name] = std::min(value, 0.9 * parameter.maximum);
  }
  return spec;
}

std::string SiteOf(const EffectType& type, const char* joint) {
  switch (type.site) {
    case EffectSite::kActuator:
      return "y_motor";
    case EffectSite::kSensor:
      return "y_encoder";
    case EffectSite::kHeldJoint:
      return "r2";
    default:
      return joint;
  }
}

TEST(EffectCatalogue, HoldsExactlyTheTwentySixEffects) {
  std::vector<std::string> names;
  for (const EffectType& type : EffectCatalogue()) names.push_back(type.name);
  EXPECT_THAT(
      names,
      ::testing::UnorderedElementsAre(
          "coulomb_friction", "stribeck_friction", "viscous_friction",
          "asymmetric_viscous_friction", "quadratic_drag", "presliding_hysteresis",
          "hysteretic_stiffness", "force_offset", "force_ripple", "motor_constant",
          "position_dependent_motor_constant", "force_saturation", "input_delay",
          "amplifier_lag", "linear_stiffness", "cubic_stiffness",
          "structural_stiffness", "added_mass", "flexible_mode", "backlash", "end_stop",
          "floor_vibration", "encoder_scale", "encoder_periodic_error", "encoder_drift",
          "encoder_noise"));
}

TEST(EffectCatalogue, IsParsedAndFormattedWithoutLoss) {
  for (const EffectType& type : EffectCatalogue()) {
    const EffectSpec spec = Example(type, "some site");
    const EffectSpec again = ParseEffect(FormatEffect(spec));
    EXPECT_EQ(again.effect, spec.effect);
    EXPECT_EQ(again.site, spec.site);
    EXPECT_EQ(again.parameters, spec.parameters) << FormatEffect(spec);
  }
}

TEST(EffectCatalogue, HasAUnitAndAMeaningForEverything) {
  for (const EffectType& type : EffectCatalogue()) {
    EXPECT_FALSE(type.meaning.empty()) << type.name;
    EXPECT_FALSE(type.parameters.empty()) << type.name;
    for (const EffectParameter& parameter : type.parameters) {
      EXPECT_FALSE(parameter.unit.empty()) << type.name << " " << parameter.name;
      EXPECT_LT(parameter.minimum, parameter.maximum) << type.name;
    }
  }
}

/// The row of an effect in docs/effects.md.
std::string DocumentedRow(const std::string& effect) {
  const std::string page = ReadTextFile(MJDIAG_SOURCE_DIR "/docs/effects.md");
  const std::size_t begin = page.find("| `" + effect + "` |");
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find('\n', begin) - begin);
}

TEST(EffectCatalogue, IsDocumentedWithUnitsAndBounds) {
  for (const EffectType& type : EffectCatalogue()) {
    std::string parameters;
    for (const EffectParameter& parameter : type.parameters) {
      parameters += (parameters.empty() ? "" : "; ") + ("`" + parameter.name + "` ");
      parameters += parameter.unit;
      if (parameter.minimum == std::numeric_limits<double>::min())
        parameters += ", > 0";
      if (parameter.name == "phase") parameters += ", -2 pi to 2 pi, default 0";
      if (parameter.minimum != 0.0) continue;
      parameters += std::isinf(parameter.maximum) ? ", >= 0" : ", 0 to 0.1";
    }
    const std::string row = DocumentedRow(type.name);
    EXPECT_THAT(row, HasSubstr("| " + parameters + " |")) << type.name;
    EXPECT_EQ(row.find("| native") != std::string::npos, type.native) << type.name;
  }
}

class CheckedEffect : public ::testing::Test {
 protected:
  std::string Refusal(const EffectSpec& spec) const {
    return test::MessageOf<InputError>([&] { CheckEffect(*plant_, spec); });
  }
  const Machine machine_ = test::Bonder();
  const ModelPtr plant_ = CopyModel(machine_.plant());
};

TEST_F(CheckedEffect, IsAcceptedAtASiteOfItsKindOnly) {
  for (const EffectType& type : EffectCatalogue()) {
    EXPECT_NO_THROW(CheckEffect(*plant_, Example(type, SiteOf(type, "X"))))
        << type.name;
    EXPECT_THAT(Refusal(Example(type, "chassis")), HasSubstr("chassis")) << type.name;
  }
}

TEST_F(CheckedEffect, NeedsASpringWhereItActsOnOne) {
  for (const char* effect :
       {"backlash@X:gap=1e-6", "structural_stiffness@X:factor=1"}) {
    EXPECT_THAT(Refusal(ParseEffect(effect)), HasSubstr("the joint has no spring"));
  }
}

TEST_F(CheckedEffect, IsRefusedOutOfTheBoundsOfEachParameter) {
  for (const EffectType& type : EffectCatalogue()) {
    for (const EffectParameter& parameter : type.parameters) {
      EffectSpec spec = Example(type, SiteOf(type, "X"));
      const auto refuses = [&](double value) {
        spec.parameters[parameter.name] = value;
        return Refusal(spec).find(parameter.name + " = ") != std::string::npos;
      };
      EXPECT_TRUE(refuses(std::nan(""))) << type.name << " " << parameter.name;
      EXPECT_TRUE(refuses(parameter.maximum * 1.01)) << type.name;
      if (parameter.minimum == std::numeric_limits<double>::min()) {
        EXPECT_TRUE(refuses(0.0)) << type.name << " " << parameter.name;
      } else if (parameter.minimum == 0.0) {
        EXPECT_TRUE(refuses(-1e-9)) << type.name << " " << parameter.name;
      }
    }
  }
}

TEST_F(CheckedEffect, NeedsEveryParameterWithoutAFallback) {
  for (const EffectType& type : EffectCatalogue()) {
    for (const EffectParameter& parameter : type.parameters) {
      EffectSpec spec = Example(type, SiteOf(type, "X"));
      spec.parameters.erase(parameter.name);
      if (parameter.fallback) {
        EXPECT_NO_THROW(CheckEffect(*plant_, spec));
        EXPECT_EQ(spec.Value(parameter.name), *parameter.fallback);
      } else {
        EXPECT_THAT(Refusal(spec), HasSubstr("'" + parameter.name + "' is missing"));
      }
    }
  }
}

TEST_F(CheckedEffect, HasUnitsOfAMomentAtAHinge) {
  const EffectSpec slide = ParseEffect("force_ripple@X:amplitude=1,period=1");
  const EffectSpec hinge = ParseEffect("force_ripple@Z:amplitude=1,period=1");
  EXPECT_EQ(SiteUnit(*plant_, slide, "amplitude"), "N");
  EXPECT_EQ(SiteUnit(*plant_, hinge, "amplitude"), "N m");
  EXPECT_EQ(SiteUnit(*plant_, hinge, "period"), "rad");
  EXPECT_EQ(SiteUnit(*plant_, hinge, "phase"), "rad");
}

// The control callback may not allocate; all effects at once, a hundred physics steps.
TEST_F(CheckedEffect, ActsWithoutAllocating) {
  std::vector<EffectSpec> specs;
  for (const EffectType& type : EffectCatalogue()) {
    specs.push_back(Example(type, SiteOf(type, "X")));
    ApplyNativeEffect(*plant_, specs.back());
  }
  ActiveEffects effects(machine_.channels(), *plant_, specs);
  const DataPtr data = MakeData(*plant_);
  std::array<double, 3> readings{};
  for (int step = 0; step < 100; ++step) {
    mj_step1(plant_.get(), data.get());
    const long before = allocations;
    effects.Distort(readings, 1e-3 * step);
    effects.Act(*plant_, *data);
    effects.Release(*data);
    ASSERT_EQ(allocations, before) << "in step " << step;
    effects.Act(*plant_, *data);
    mj_step2(plant_.get(), data.get());
  }
  EXPECT_GT(allocations, 0) << "the counter does not count";
}

TEST(CarriedEffect, MayBeThereSeveralTimesInOneNumeric) {
  const ModelPtr model = test::ModelOf(R"(<mujoco><custom>
      <numeric name="effect.force_ripple.q" data="1 0.2 0.3 4 0.5 0.6"/></custom>
    <worldbody><body><joint name="q" type="slide"/><geom size="0.1"/></body></worldbody>
  </mujoco>)");
  const std::vector<EffectSpec> effects = EffectsOf(*model);
  ASSERT_EQ(effects.size(), 2u);
  EXPECT_EQ(FormatEffect(effects[0]),
            "force_ripple@q:amplitude=1,period=0.2,phase=0.3");
  EXPECT_EQ(FormatEffect(effects[1]),
            "force_ripple@q:amplitude=4,period=0.5,phase=0.6");
}

TEST(CarriedEffect, IsRefusedWithAWrongNumberOfValues) {
  const ModelPtr model = test::ModelOf(R"(<mujoco><custom>
      <numeric name="effect.force_ripple.q" data="1 0.2 0.3 4"/></custom>
    <worldbody><body><joint name="q" type="slide"/><geom size="0.1"/></body></worldbody>
  </mujoco>)");
  EXPECT_THAT(
      test::MessageOf<InputError>([&] { EffectsOf(*model); }),
      HasSubstr("4 values; expected 3 or several times that: amplitude, period"));
}

TEST(NativeEffect, TakesAwayNoMoreThanThereIs) {
  const auto message = [](const char* effect) {
    return test::MessageOf<InputError>([&] { test::EffectBench bench({effect}); });
  };
  EXPECT_THAT(message("added_mass@q:mass=-2"), HasSubstr("more mass than there is"));
  EXPECT_THAT(message("viscous_friction@q:coefficient=-1"),
              HasSubstr("more damping than there is"));
}

}  // namespace
}  // namespace mjdiag
