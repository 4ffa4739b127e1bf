#include "mjdiag/plugin/extension/calibrated_setup.h"

#include <gtest/gtest.h>

#include <string>

#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

class CalibratedSetupText : public ::testing::Test {
 protected:
  std::string Calibrated(const std::string& setup) const {
    return CalibratedSetup(folder_.Write("setup.toml", setup), "calibration.json");
  }

  const test::TemporaryFolder folder_;
};

TEST_F(CalibratedSetupText, NamesTheCalibrationBeforeTheFirstTable) {
  EXPECT_EQ(Calibrated(R"(plant = "stage.xml"  # mine
name = "s"

[rates]
control = 1000.0
)"),
            R"(plant = "stage.xml"  # mine
calibration = "calibration.json"
name = "s"

[rates]
control = 1000.0
)");
}

TEST_F(CalibratedSetupText, NeedsNoTableAndNoLastLineEnd) {
  EXPECT_EQ(Calibrated(R"(rates.control = 1000.0
plant = 'stage.xml')"),
            R"(rates.control = 1000.0
plant = 'stage.xml'
calibration = "calibration.json"
)");
}

TEST_F(CalibratedSetupText, ReplacesAnEarlierOne) {
  EXPECT_EQ(Calibrated(R"(  calibration='old.json' # of May
plant = "stage.xml"
[rates]
)"),
            R"(  calibration="calibration.json" # of May
plant = "stage.xml"
[rates]
)");
  EXPECT_EQ(Calibrated(R"(plant = "stage.xml"
"calibration" = "a = b"
)"),
            R"(plant = "stage.xml"
"calibration" = "calibration.json"
)");
}

TEST_F(CalibratedSetupText, TakesNothingElseForOne) {
  const std::string head = R"(# calibration = "none"
name = """
[calibration]
calibration = 1"""
plant = "stage.xml"
)";
  const std::string table = R"([studies.tolerance]
calibration = 1.0
)";
  EXPECT_EQ(Calibrated(head + table),
            head + "calibration = \"calibration.json\"\n" + table);
}

TEST_F(CalibratedSetupText, IsFoundByItsFolderToo) {
  const std::string text = Calibrated("plant = \"stage.xml\"\n");
  EXPECT_EQ(CalibratedSetup(folder_.path(), "calibration.json"), text);
}

}  // namespace
}  // namespace mjdiag
