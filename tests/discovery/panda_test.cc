// A seven-joint arm, really measured: time stamps that jitter, two gaps, values that stand
// for two samples, a rest to begin with. The data belongs to its authors and is not part of
// this repository: the folder is named by MJDIAG_PANDA_DATA.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "mjdiag/discovery/checks/data_check.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kJoints = 7;

std::filesystem::path ArmFolder() {
  const char* named = std::getenv("MJDIAG_PANDA_DATA");
  return named != nullptr ? named : "";
}

/// A stand-in with as many joints, motors and encoders, without gravity.
void WriteArm(const std::filesystem::path& folder) {
  std::string bodies;
  std::string ends;
  std::string motors;
  std::string encoders;
  std::string setup =
      "schema = \"mjdiag.setup/1\"\nname = \"Arm\"\nplant = \"plant.xml\"\n"
      "[rates]\ncontrol = 1000.0\nsubsteps = 1\n";
  for (int i = 1; i <= kJoints; ++i) {
    const std::string number = std::to_string(i);
    const std::string axis = i % 2 == 0 ? "0 1 0" : "0 0 1";
    bodies +=
        "<body pos=\"0 0 0.2\"><inertial pos=\"0 0 0.1\" mass=\"3\" "
        "diaginertia=\"0.1 0.1 0.05\"/><joint name=\"joint" +
        number + "\" type=\"hinge\" axis=\"" + axis + "\" damping=\"5\"/>";
    ends += "</body>";
    motors += "<motor name=\"motor" + number + "\" joint=\"joint" + number + "\"/>";
    encoders +=
        "<jointpos name=\"encoder" + number + "\" joint=\"joint" + number + "\"/>";
    setup += "[sensors.q" + number + "]\nelement = \"encoder" + number +
             "\"\nunit = \"rad\"\n[actuators.tau" + number + "]\nelement = \"motor" +
             number + "\"\nunit = \"N m\"\n";
  }
  WriteTextFile(folder / "plant.xml",
                "<mujoco><option timestep=\"0.001\" gravity=\"0 0 0\"/><worldbody>" +
                    bodies + ends + "</worldbody><actuator>" + motors +
                    "</actuator><sensor>" + encoders + "</sensor></mujoco>");
  WriteTextFile(folder / "setup.toml", setup);
}

class Arm : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(File())) {
      ASSERT_EQ(std::getenv("CI"), nullptr) << "no data of the arm in " << ArmFolder();
      GTEST_SKIP() << "no data of the arm: MJDIAG_PANDA_DATA names no folder with "
                      "exciting_motion.csv";
    }
    WriteArm(folder_.path());
  }
  static std::filesystem::path File() { return ArmFolder() / "exciting_motion.csv"; }
  const test::TemporaryFolder folder_;
};

TEST_F(Arm, IsReadAsItWasLogged) {
  const mjdiag::Setup setup = ReadSetup(folder_.path());
  const MeasuredFile file = ReadMeasured(setup, File());
  EXPECT_EQ(file.record.sample_time(), 0.001);
  EXPECT_GE(file.record.samples(), 13990);
  EXPECT_THAT(file.notes,
              ElementsAre(HasSubstr("time stamps are irregular"),
                          HasSubstr("2 gaps of up to 8.81 ms, the first at 4.9"),
                          HasSubstr("and 4 more repeat values while in motion")));
  const MeasuredRun run = ToMeasuredRun(setup, file.record);
  for (Index joint = 0; joint < kJoints; ++joint) {
    const SampleMask measured = run.CountedOf(joint, 0, run.samples());
    // The gaps, and what is repeated for longer than once.
    EXPECT_GT(measured.count(), run.samples() - 200) << joint;
    EXPECT_LT(measured.count(), run.samples() - 10) << joint;
    EXPECT_TRUE(measured.head(12).all()) << joint;  // it rests
  }
}

TEST_F(Arm, IsNotRefusedByTheChecks) {
  const Machine machine(ReadSetup(folder_.path()));
  const MeasuredFile file = ReadMeasured(machine.setup(), File());
  EXPECT_NO_THROW(CheckRecord(machine, file.record));
}

}  // namespace
}  // namespace mjdiag
