// The walk of docs/own-machine.md, line by line as it stands there.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "app/command_line.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kHidden = 4e6;  // N/m^3, as in the document

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// A folder in which the document's "out/voice_coil" lies.
class OwnMachine : public ::testing::Test {
 protected:
  /// The line of a code block of the document that begins so, without its indent.
  std::string Line(const std::string& beginning) const {
    std::istringstream document(
        ReadAll(fs::path(MJDIAG_SOURCE_DIR) / "docs" / "own-machine.md"));
    for (std::string line; std::getline(document, line);) {
      if (line.rfind("    " + beginning, 0) == 0) {
        return Replaced(line.substr(4), "out/voice_coil", folder_.path().string());
      }
    }
    ADD_FAILURE() << "no line '" << beginning << "'";
    return "";
  }
  CommandResult Walk(const std::string& command) const {
    const std::string line = Line("mjdiag " + command);
    return RunCommand(line.substr(std::string("mjdiag ").size()));
  }
  void Measure() const {
    ASSERT_EQ(std::system(Line("awk ").c_str()), 0);
    const CommandResult measured = Walk("simulate");
    ASSERT_EQ(measured.status, 0) << measured.err;
  }
  json Json(const std::string& file) const {
    return json::parse(ReadAll(folder_ / file));
  }

  const TemporaryFolder folder_;
};

TEST_F(OwnMachine, WalkEndsAtTheHiddenCause) {
  Measure();
  EXPECT_EQ(Walk("compare").status, 0);
  EXPECT_EQ(Json("compared/compare.json")["channels"]["x"]["exceeds_noise"], true);

  const CommandResult found = Walk("discover");
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, StartsWith("Found: cubic_stiffness at stage (coefficient "));
  const json discovery = Json("found/discovery.json");
  EXPECT_EQ(discovery["verdict"], "explained");
  ASSERT_EQ(discovery["causes"].size(), 1u) << discovery["causes"].dump(2);
  const json& cause = discovery["causes"][0];
  EXPECT_EQ(cause["effect"], "cubic_stiffness");
  EXPECT_EQ(cause["site"], "stage");
  const json& coefficient = cause["parameters"]["coefficient"];
  EXPECT_EQ(coefficient["unit"], "N/m^3");
  // One record in 20 misses a 95 % interval; none in 10^8 misses this one.
  EXPECT_NEAR(coefficient["value"], kHidden, 6.0 * coefficient["sd"].get<double>());
  EXPECT_LT(coefficient["sd"], 0.01 * kHidden);
  EXPECT_GT(discovery["gain"]["validation"], 0.99);
  EXPECT_THAT(ReadAll(folder_ / "found/report.html"), HasSubstr("cubic_stiffness"));

  EXPECT_TRUE(fs::exists(discovery["extended_plant"].get<std::string>()));
  const std::string again =
      Line("mjdiag compare --setup " + std::string("out/voice_coil/found"));
  EXPECT_EQ(RunCommand(again.substr(7)).status, 0);
  EXPECT_EQ(Json("checked/compare.json")["channels"]["x"]["exceeds_noise"], false);
}

TEST_F(OwnMachine, NamesNothingWhereNothingIsHidden) {
  ASSERT_EQ(std::system(Line("awk ").c_str()), 0);
  const std::string out = folder_.path().string();
  const std::string machine = "--setup mjcf/voice_coil ";
  ASSERT_EQ(RunCommand("simulate " + machine + "--replay '" + out +
                       "/current.csv' --out '" + out + "/measured'")
                .status,
            0);
  const CommandResult found =
      RunCommand("discover " + machine + "--record '" + out +
                 "/measured/record.csv' --out '" + out + "/found' --json");
  EXPECT_EQ(found.status, 0) << found.err;
  const json discovery = json::parse(found.out);
  EXPECT_EQ(discovery["verdict"], "no_discrepancy");
  EXPECT_EQ(discovery["causes"], json::array());
  EXPECT_TRUE(discovery["extended_plant"].is_null());
  EXPECT_FALSE(fs::exists(folder_ / "found/extended"));
}

TEST_F(OwnMachine, SetupOfTheDocumentIsTheOneOfTheFolder) {
  const fs::path source = MJDIAG_SOURCE_DIR;
  std::string setup = ReadAll(source / "mjcf" / "voice_coil" / "setup.toml");
  const std::size_t begin = setup.find("schema");
  const std::size_t end = setup.find("\n# Two states");
  ASSERT_NE(end, std::string::npos);
  EXPECT_THAT(ReadAll(source / "docs" / "own-machine.md"),
              HasSubstr(setup.substr(begin, end - begin)));
}

TEST_F(OwnMachine, DiscoverRefusesWhatThePlantsFileDoesNotHave) {
  const CommandResult refused = RunCommand(
      "discover --setup mjcf/voice_coil --record none.csv --fault eta=1.1 --out '" +
      folder_.path().string() + "'");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("expected what is known beforehand in the MJCF"));
}

}  // namespace
}  // namespace mjdiag
