// What holds for every registered effect.

#include "mjdiag/plugin/effects/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <regex>

#include "mjdiag/plugin/effects/fault_effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "plugin/effects/effect_bench.h"
#include "support/bonder.h"
#include "support/count_allocations.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

/// Values inside the bounds of each parameter, all of them with many digits.
std::map<std::string, double> ExampleValues(const Effect& effect) {
  std::map<std::string, double> values;
  double value = 1.0 / 3.0;
  for (const EffectParameter& parameter : effect.parameters()) {
    value *= 0.7;
    values[parameter.name] =
        std::clamp(value, parameter.minimum, 0.9 * parameter.maximum);
  }
  return values;
}

PlacedEffect Example(const Effect& effect, const std::string& site) {
  return Place(effect.name(), site, ExampleValues(effect));
}

std::string SiteOf(const Effect& effect, const char* joint) {
  switch (effect.site()) {
    case SiteKind::kActuator:
      return "y_motor";
    case SiteKind::kSensor:
      // The others read frames, not joints.
      return &effect == &TransmissionWindup() ? "z_encoder" : "y_encoder";
    case SiteKind::kHeldJoint:
      return "r2";
    case SiteKind::kHinge:
      return "Z";
    default:
      return joint;
  }
}

/// The names in docs/effects.md, in their order.
std::vector<std::string> DocumentedNames() {
  const std::string page = ReadTextFile(MJDIAG_SOURCE_DIR "/docs/effects.md");
  const std::regex row(R"(\n\| `([a-z_]+)` \|)");
  std::vector<std::string> names;
  for (std::sregex_iterator i(page.begin(), page.end(), row), end; i != end; ++i) {
    names.push_back((*i)[1]);
  }
  return names;
}

TEST(Registry, HoldsExactlyTheDocumentedEffects) {
  std::vector<std::string> names;
  for (const Effect* effect : Effects()) names.push_back(effect->name());
  EXPECT_GE(names.size(), 26u);
  // The tables of the page are by family; a later effect is the last of the list.
  EXPECT_THAT(names, ::testing::UnorderedElementsAreArray(DocumentedNames()));
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

TEST(Registry, HasEveryEffectInTheFolderOfItsFamily) {
  namespace fs = std::filesystem;
  for (const Effect* effect : Effects()) {
    const fs::path folder =
        fs::path(MJDIAG_SOURCE_DIR) / "plugin/effects" / FamilyName(effect->family());
    EXPECT_TRUE(fs::exists(folder / (effect->name() + ".cc"))) << effect->name();
  }
}

TEST(Registry, IsParsedAndFormattedWithoutLoss) {
  for (const Effect* effect : Effects()) {
    const PlacedEffect placed = Example(*effect, "some site");
    const PlacedEffect again = ParseEffect(FormatEffect(placed));
    EXPECT_EQ(again.name(), placed.name());
    EXPECT_EQ(again.site, placed.site);
    EXPECT_EQ(again.values, placed.values) << FormatEffect(placed);
  }
}

TEST(Registry, HasAUnitAndAMeaningForEverything) {
  for (const Effect* effect : Effects()) {
    EXPECT_FALSE(effect->meaning().empty()) << effect->name();
    EXPECT_FALSE(effect->parameters().empty()) << effect->name();
    for (const EffectParameter& parameter : effect->parameters()) {
      EXPECT_FALSE(parameter.unit.empty()) << effect->name() << " " << parameter.name;
      EXPECT_LT(parameter.minimum, parameter.maximum) << effect->name();
    }
  }
}

std::string Short(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// The row of an effect in docs/effects.md.
std::string DocumentedRow(const std::string& effect) {
  const std::string page = ReadTextFile(MJDIAG_SOURCE_DIR "/docs/effects.md");
  const std::size_t begin = page.find("| `" + effect + "` |");
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find('\n', begin) - begin);
}

TEST(Registry, IsDocumentedWithUnitsAndBounds) {
  for (const Effect* effect : Effects()) {
    std::string parameters;
    for (const EffectParameter& parameter : effect->parameters()) {
      parameters += (parameters.empty() ? "" : "; ") + ("`" + parameter.name + "` ");
      parameters += parameter.unit;
      if (parameter.minimum == std::numeric_limits<double>::min())
        parameters += ", > 0";
      if (parameter.role == Role::kPhase) parameters += ", -2 pi to 2 pi, default 0";
      const bool bounded = std::isfinite(parameter.maximum);
      if (bounded && parameter.role != Role::kPhase) {
        parameters +=
            ", " + Short(parameter.minimum) + " to " + Short(parameter.maximum);
      } else if (parameter.minimum == 0.0) {
        parameters += ", >= 0";
      }
    }
    const std::string row = DocumentedRow(effect->name());
    EXPECT_THAT(row, HasSubstr("| " + parameters + " |")) << effect->name();
    EXPECT_EQ(row.find("| native") != std::string::npos,
              (effect->form() == Form::kAttributes))
        << effect->name();
  }
}

class CheckedEffect : public ::testing::Test {
 protected:
  std::string Refusal(const PlacedEffect& placed) const {
    return test::MessageOf<InputError>([&] { CheckEffect(*plant_, placed); });
  }
  const Machine machine_ = test::Bonder();
  const ModelPtr plant_ = CopyModel(machine_.plant());
};

TEST_F(CheckedEffect, IsAcceptedAtASiteOfItsKindOnly) {
  for (const Effect* effect : Effects()) {
    EXPECT_NO_THROW(CheckEffect(*plant_, Example(*effect, SiteOf(*effect, "X"))))
        << effect->name();
    EXPECT_THAT(Refusal(Example(*effect, "chassis")), HasSubstr("chassis"))
        << effect->name();
  }
}

TEST_F(CheckedEffect, NeedsASpringWhereItActsOnOne) {
  for (const char* effect :
       {"backlash@X:gap=1e-6", "structural_stiffness@X:factor=1"}) {
    EXPECT_THAT(Refusal(ParseEffect(effect)), HasSubstr("the joint has no spring"));
  }
}

TEST_F(CheckedEffect, NeedsAHingeWhereItTurns) {
  EXPECT_THAT(Refusal(ParseEffect("zero_offset@X:offset=0.1")),
              HasSubstr("the joint is a slide; expected a hinge"));
}

/// What Place and, with the same values, CheckEffect say.
TEST_F(CheckedEffect, IsRefusedOutOfTheBoundsOfEachParameter) {
  for (const Effect* effect : Effects()) {
    Eigen::Index place = 0;
    for (const EffectParameter& parameter : effect->parameters()) {
      const std::string site = SiteOf(*effect, "X");
      const std::string complaint = parameter.name + " = ";
      PlacedEffect placed = Example(*effect, site);
      std::map<std::string, double> values = ExampleValues(*effect);
      const auto refuses = [&](double value) {
        values[parameter.name] = placed.values[place] = value;
        const std::string by_name =
            test::MessageOf<InputError>([&] { Place(effect->name(), site, values); });
        EXPECT_EQ(by_name, Refusal(placed));
        return by_name.find(complaint) != std::string::npos;
      };
      EXPECT_TRUE(refuses(std::nan(""))) << effect->name() << " " << parameter.name;
      EXPECT_TRUE(refuses(parameter.maximum * 1.01)) << effect->name();
      if (parameter.minimum == std::numeric_limits<double>::min()) {
        EXPECT_TRUE(refuses(0.0)) << effect->name() << " " << parameter.name;
      } else if (parameter.minimum == 0.0) {
        EXPECT_TRUE(refuses(-1e-9)) << effect->name() << " " << parameter.name;
      }
      ++place;
    }
  }
}

TEST_F(CheckedEffect, NeedsEveryParameterWithoutAFallback) {
  for (const Effect* effect : Effects()) {
    for (const EffectParameter& parameter : effect->parameters()) {
      std::map<std::string, double> values = ExampleValues(*effect);
      values.erase(parameter.name);
      const auto placed = [&] { return Place(effect->name(), "X", values); };
      if (parameter.fallback) {
        EXPECT_EQ(placed().Value(parameter.name), *parameter.fallback);
      } else {
        EXPECT_THAT(test::MessageOf<InputError>(placed),
                    HasSubstr("'" + parameter.name + "' is missing"));
      }
    }
  }
}

TEST_F(CheckedEffect, HasUnitsOfAMomentAtAHinge) {
  const auto unit = [&](const char* joint, const char* parameter) {
    const Effect& ripple = FindEffect("force_ripple");
    const auto place = static_cast<std::size_t>(ripple.Find(parameter).value());
    return SiteUnit(*plant_, ripple, joint, ripple.parameters()[place]);
  };
  EXPECT_EQ(unit("X", "amplitude"), "N");
  EXPECT_EQ(unit("Z", "amplitude"), "N m");
  EXPECT_EQ(unit("Z", "period"), "rad");
  EXPECT_EQ(unit("Z", "phase"), "rad");
}

// beta_y of the bonder is the stiffness of two joints at once: there is none of that name.
TEST_F(CheckedEffect, OfAFaultOfSeveralJointsHasTheUnitOfAFactor) {
  int several = 0;
  for (const PlacedEffect& fault : FaultEffects(*plant_)) {
    several += fault.site.find(' ') != std::string::npos ? 1 : 0;
    EXPECT_EQ(
        SiteUnit(*plant_, *fault.effect, fault.site, fault.effect->parameters()[0]),
        "1");
  }
  EXPECT_GT(several, 0);
}

// The control callback may not allocate; all effects at once, a hundred physics steps.
TEST_F(CheckedEffect, ActsWithoutAllocating) {
  std::vector<PlacedEffect> specs;
  for (const Effect* effect : Effects()) {
    specs.push_back(Example(*effect, SiteOf(*effect, "X")));
    ApplyEffect(*plant_, specs.back());
  }
  ActiveEffects effects(machine_.channels(), *plant_, specs);
  const DataPtr data = MakeData(*plant_);
  std::array<double, 3> readings{};
  for (int step = 0; step < 100; ++step) {
    mj_step1(plant_.get(), data.get());
    const long allocated = test::CountAllocations([&] {
      effects.Distort(*plant_, *data, readings, 1e-3 * step);
      effects.Act(*plant_, *data);
      effects.Release(*data);
    });
    ASSERT_EQ(allocated, 0) << "in step " << step;
    effects.Act(*plant_, *data);
    mj_step2(plant_.get(), data.get());
  }
  EXPECT_EQ(test::allocations > 0, test::kCountsAllocations);
}

TEST(CarriedEffect, MayBeThereSeveralTimesInOneNumeric) {
  const ModelPtr model = test::ModelOf(R"(<mujoco><custom>
      <numeric name="effect.force_ripple.q" data="1 0.2 0.3 4 0.5 0.6"/></custom>
    <worldbody><body><joint name="q" type="slide"/><geom size="0.1"/></body></worldbody>
  </mujoco>)");
  const std::vector<PlacedEffect> effects = EffectsOf(*model);
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
