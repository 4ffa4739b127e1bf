#include "mjdiag/plugin/setup/chain_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kStage = R"(schema = "mjdiag.linear_chain/1"
[[bodies]]
name = "stage"
mass = 2.0
centre = [0, 0, 0.1]
inertia = [0.01, 0.01, 0.02]
[[bodies.joints]]
name = "X"
type = "slide"
axis = [1, 0, 0]
damping = 10.0
[[actuators]]
name = "u"
body = "stage"
type = "linear"
axis = [1, 0, 0]
point = [0, 0, 0]
)";

auto Read(const std::string& text) {
  const test::TemporaryFolder folder;
  return ReadLinearChain(folder.Write("chain_file_test.toml", text));
}

std::string ErrorAfter(const std::string& from, const std::string& to) {
  std::string text = kStage;
  text.replace(text.find(from), from.size(), to);
  return test::MessageOf<InputError>([&] { Read(text); });
}

TEST(ChainFile, ReadsWhatItSays) {
  const LinearChain chain = Read(kStage);
  ASSERT_EQ(chain.bodies.size(), 1u);
  EXPECT_EQ(chain.bodies[0].mass, 2.0);
  EXPECT_EQ(chain.bodies[0].inertia.z(), 0.02);
  ASSERT_EQ(chain.bodies[0].joints.size(), 1u);
  EXPECT_FALSE(chain.bodies[0].joints[0].hinge);
  EXPECT_EQ(chain.bodies[0].joints[0].damping, 10.0);
  EXPECT_EQ(chain.bodies[0].joints[0].stiffness, 0.0);
  ASSERT_EQ(chain.actuators.size(), 1u);
  EXPECT_EQ(chain.actuators[0].body, "stage");
  EXPECT_EQ(chain.actuators[0].base, "");
  EXPECT_TRUE(chain.sensors.empty());
}

TEST(ChainFile, SaysFileLineAndKeyOfWhatIsWrong) {
  EXPECT_THAT(ErrorAfter("mass = 2.0", "mass = \"two\""),
              AllOf(HasSubstr("chain_file_test.toml:4: "), HasSubstr("mass")));
  EXPECT_THAT(ErrorAfter("mass = 2.0", "mas = 2.0"), HasSubstr("bodies[0].mass"));
  EXPECT_THAT(ErrorAfter("damping = 10.0", "dampin = 10.0"),
              AllOf(HasSubstr("chain_file_test.toml:11: "), HasSubstr("dampin")));
  EXPECT_THAT(ErrorAfter("axis = [1, 0, 0]", "axis = [1, 1, 0]"),
              AllOf(HasSubstr("chain_file_test.toml:10: "), HasSubstr("unit")));
  EXPECT_THAT(ErrorAfter("axis = [1, 0, 0]", "axis = [1, 0]"), HasSubstr("three"));
  EXPECT_THAT(ErrorAfter("type = \"slide\"", "type = \"ball\""),
              AllOf(HasSubstr("chain_file_test.toml:9: "), HasSubstr("ball")));
  EXPECT_THAT(ErrorAfter("body = \"stage\"", "body = \"stge\""),
              AllOf(HasSubstr("chain_file_test.toml:14: "), HasSubstr("stge")));
  EXPECT_THAT(ErrorAfter("linear_chain/1", "setup/1"), HasSubstr("schema"));
  EXPECT_THAT(ErrorAfter("[[bodies]]", "[[bodies]"),
              HasSubstr("chain_file_test.toml:2"));
}

}  // namespace
}  // namespace mjdiag
