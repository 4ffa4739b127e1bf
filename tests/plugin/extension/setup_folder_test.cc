#include "mjdiag/plugin/extension/setup_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/extension/effects_file.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

const std::filesystem::path kCoil =
    std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf" / "voice_coil";

TEST(SetupFolder, OfAnExtendedPlantIsThatMachine) {
  const test::TemporaryFolder folder;
  const Machine coil(ReadSetup(kCoil));
  const Changes changes{{{"zeta", 1.2}},
                        {ParseEffect("cubic_stiffness@stage:coefficient=4e6")}};
  const auto extended = folder.path() / "extended";
  EXPECT_EQ(WriteExtendedSetup(extended, kCoil, coil, changes), extended / "plant.xml");
  const Machine read(ReadSetup(extended));
  EXPECT_EQ(read.effects(), changes.effects);
  EXPECT_EQ(read.linear().D, coil.With(changes).linear().D);
}

TEST(SetupFolder, HasAPythonFileWhereThePlantCarriesWhatMujocoDoesNotHave) {
  const test::TemporaryFolder folder;
  const Machine coil(ReadSetup(kCoil));
  const auto write = [&](const std::string& effect) {
    WriteExtendedSetup(folder.path(), kCoil, coil, {{}, {ParseEffect(effect)}});
    return std::filesystem::exists(folder / kEffectsFile);
  };
  EXPECT_TRUE(write("cubic_stiffness@stage:coefficient=4e6"));
  EXPECT_EQ(ReadTextFile(folder / kEffectsFile), EffectsPython());
  // Of the plant before.
  EXPECT_FALSE(write("viscous_friction@stage:coefficient=1"));
  EXPECT_FALSE(write("encoder_noise@encoder:sd=1e-8"));
}

TEST(SetupFolder, LeavesAFileOfSomebodyElseWhereNoneIsNeeded) {
  const test::TemporaryFolder folder;
  folder.Write(kEffectsFile, "import mujoco\n");
  WriteExtendedSetup(folder.path(), kCoil, Machine(ReadSetup(kCoil)), {});
  EXPECT_EQ(ReadTextFile(folder / kEffectsFile), "import mujoco\n");
}

TEST(SetupFolder, OfAPlantThatCarriesEffectsAlreadyHasThePythonFile) {
  const test::TemporaryFolder folder;
  const Machine coil(ReadSetup(kCoil));
  WriteExtendedSetup(folder / "once", kCoil, coil,
                     {{}, {ParseEffect("force_offset@stage:force=0.1")}});
  WriteExtendedSetup(folder / "twice", folder / "once",
                     Machine(ReadSetup(folder / "once")), {});
  EXPECT_TRUE(std::filesystem::exists(folder / "twice" / kEffectsFile));
}

TEST(SetupFolder, OfAPlantInFinerStepsHasThese) {
  const test::TemporaryFolder folder;
  const Machine coil(ReadSetup(kCoil));
  const Machine finer = coil.WithSubsteps(2 * coil.rates().substeps);
  WriteExtendedSetup(folder.path() / "extended", kCoil, finer, {});
  const Machine read(ReadSetup(folder.path() / "extended"));
  EXPECT_EQ(read.rates().substeps, finer.rates().substeps);
  EXPECT_EQ(read.plant().opt.timestep, finer.plant().opt.timestep);
}

TEST(SetupFolder, OfACalibratedMachineIsASetupOfItsOwn) {
  const test::TemporaryFolder folder;
  const Machine coil(ReadSetup(kCoil));
  Calibration calibration;
  calibration.numbers = {"mass@stage"};
  calibration.factors = Eigen::VectorXd::Constant(1, 1.01);
  calibration.root = Eigen::MatrixXd::Constant(1, 1, 0.001);
  calibration.sensor_noise = Eigen::VectorXd::Constant(1, 4e-8);
  calibration.records = 1;
  const DiagnosisDesign filters = DesignFilters(coil);
  WriteCalibratedSetup(folder.path() / "calibrated", kCoil, calibration, filters);
  const auto read = ReadSetup(folder.path() / "calibrated");
  EXPECT_EQ(read.calibration, calibration);
  EXPECT_TRUE(std::filesystem::exists(read.folder / kCalibratedFilters));
  EXPECT_TRUE(std::filesystem::exists(read.plant));
  EXPECT_EQ(read.plant.parent_path(), read.folder);
}

TEST(SetupFolder, IsNeverThatOfTheSetupItself) {
  const test::TemporaryFolder folder;
  const auto copy = folder.path() / "coil";
  std::filesystem::copy(kCoil, copy);
  EXPECT_THROW(WriteCalibratedSetup(copy, copy, {}, {}), InputError);
  EXPECT_THROW(WriteExtendedSetup(copy, copy, Machine(ReadSetup(copy)), {}),
               InputError);
}

}  // namespace
}  // namespace mjdiag
