// Setup files as other people write them: every way that TOML has to say the same.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/extension/extended_plant.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kHead = "schema = \"mjdiag.setup/1\"\n";
constexpr const char* kRest =
    "[rates]\ncontrol = 1000.0\n[actuators.u]\nelement = \"motor\"\nunit = \"N\"\n";

class ExtendedSetup : public ::testing::Test {
 protected:
  /// Extends a setup with 3 um of noise at "encoder" and reads the result.
  std::string Extend(const std::string& setup) {
    nominal_.Write("stage.xml", "x");
    extended_.Write("plant.xml", "x");
    const std::string file = nominal_.Write("setup.toml", setup);
    std::string text =
        ExtendSetup(file, ReadSetup(file),
                    {ParseEffect("encoder_noise@encoder:sd=3e-6")}, extended_.path());
    setup_ = ReadSetup(extended_.Write("setup.toml", text));
    return text;
  }

  const test::TemporaryFolder nominal_;
  const test::TemporaryFolder extended_;
  mjdiag::Setup setup_;
};

TEST_F(ExtendedSetup, AddsNoiseToATable) {
  const std::string text =
      Extend(std::string(kHead) + "name = 'stage'\nplant = 'stage.xml' # mine\n" +
             kRest + "[sensors.q]\n  unit = \"m\"\n  element = \"encoder\" # Größe\n");
  EXPECT_EQ(setup_.channels.Sensor("q").noise_sd, 3e-6);
  EXPECT_EQ(setup_.name, "stage (extended)");
  EXPECT_THAT(text, HasSubstr("plant = \"plant.xml\" # mine\n"));
  EXPECT_THAT(text, HasSubstr("  element = \"encoder\" # Größe\n  noise_sd = 3e-06\n"));
}

TEST_F(ExtendedSetup, AddsNoiseToAnInlineTableBehindWordsOfManyBytes) {
  Extend(std::string(kHead) +
         "name = \"\"\"Tisch größer\"\"\"\nplant = \"stage.xml\"\n" + kRest +
         "[sensors]\n"
         "q = { unit = \"m\", element = \"encoder\", resolution = 1e-9 }\n");
  EXPECT_EQ(setup_.channels.Sensor("q").noise_sd, 3e-6);
  EXPECT_EQ(setup_.channels.Sensor("q").resolution, 1e-9);
  EXPECT_EQ(setup_.name, "Tisch größer (extended)");
}

TEST_F(ExtendedSetup, AddsNoiseToDottedKeysOnALastLineWithoutEnd) {
  Extend(std::string(kHead) + "name = \"s\"\nplant = \"stage.xml\"\n" + kRest +
         "[sensors]\nq.unit = \"m\"\nq.element = \"encoder\"");
  EXPECT_EQ(setup_.channels.Sensor("q").noise_sd, 3e-6);
}

TEST_F(ExtendedSetup, AddsToTheNoiseThatThereIsInItsOwnKey) {
  const std::string text = Extend(
      std::string(kHead) + "name = \"s\"\nplant = \"stage.xml\"\n" + kRest +
      "[sensors.q]\nunit = \"m\"\nelement = \"encoder\"\nnoise_power = 1.6e-14\n"
      "[sensors.r]\nunit = \"m\"\nelement = \"encoder\"\nnoise_sd = 4e-6 # known\n"
      "[sensors.s]\nunit = \"m\"\nelement = \"other\"\nnoise_sd = 4e-6\n");
  // sqrt(1.6e-14 * 1000) is 4 um.
  EXPECT_NEAR(setup_.channels.Sensor("q").noise_sd, 5e-6, 1e-18);
  EXPECT_NEAR(setup_.channels.Sensor("r").noise_sd, 5e-6, 1e-18);
  EXPECT_EQ(setup_.channels.Sensor("s").noise_sd, 4e-6);
  EXPECT_THAT(text, HasSubstr(" # known\n"));
}

TEST_F(ExtendedSetup, LeavesOutWhatDescribesTheOldPlant) {
  for (const char* name : {"analytic.toml", "row.toml"}) nominal_.Write(name, "x");
  const std::string text =
      Extend(std::string(kHead) +
             "name = \"s\"\nanalytic = \"analytic.toml\"\nplant = \"stage.xml\"\n"
             "published = \"row.toml\" # printed\n" +
             kRest + "[sensors.q]\nunit = \"m\"\nelement = \"encoder\"\n" +
             "[physics]\nstatic_friction = false\ngravity = false\n");
  EXPECT_THAT(text, Not(HasSubstr("analytic")));
  EXPECT_THAT(text, Not(HasSubstr("printed")));
  // What of it is left is in the extended plant.
  EXPECT_TRUE(setup_.physics.static_friction);
  EXPECT_FALSE(setup_.physics.gravity);
}

}  // namespace
}  // namespace mjdiag
