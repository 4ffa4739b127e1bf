#include "mjdiag/plugin/plant/scenery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

// Every kind of constraint, all of them at work at once: margins are wider than ranges.
const std::string kConstrained = R"(
<mujoco>
  <option gravity="0.3 0.2 -9.81"/>
  <default>
    <joint limited="true" range="-0.1 0.1" margin="1" frictionloss="0.2"/>
    <geom contype="CONTACT" conaffinity="0"/>
  </default>
  <worldbody>
    <site name="fixed"/>
    <body name="cart">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <joint name="hinge" axis="0 1 0"/>
      <geom size="0.1"/>
      <body name="arm" pos="0.3 0 0">
        <joint name="ball" type="ball" range="0 0.1"/>
        <geom size="0.05"/>
        <site name="tip" pos="0.2 0 0"/>
      </body>
    </body>
    <body name="loose" pos="0 0 1"><freejoint/><geom size="0.1"/></body>
    <body name="held" pos="0 1 0"><freejoint/><geom size="0.1"/></body>
  </worldbody>
  <tendon>
    <spatial name="wire" limited="true" range="0.1 0.6" margin="1" frictionloss="0.1">
      <site site="fixed"/><site site="tip"/>
    </spatial>
    <fixed name="gear" limited="true" range="-0.1 0.1" margin="1" frictionloss="0.1">
      <joint joint="slide" coef="1"/><joint joint="hinge" coef="2"/>
    </fixed>
  </tendon>
  <equality>
    <weld body1="held" body2="cart"/>
    <connect body1="loose" body2="arm" anchor="0 0 -0.5"/>
    <joint joint1="slide" joint2="hinge"/>
    <tendon tendon1="wire" tendon2="gear"/>
  </equality>
</mujoco>)";

/// As MuJoCo loads it.
ModelPtr LoadUnchanged(const std::string& file) {
  std::array<char, 1000> error{};
  return ModelPtr(mj_loadXML(file.c_str(), nullptr, error.data(), error.size()));
}

class UnusedRows : public testing::Test {
 protected:
  std::string Write(const std::string& contype) {
    std::string text = kConstrained;
    text.replace(text.find("CONTACT"), 7, contype);
    return folder_.Write("constrained.xml", text);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(UnusedRows, AreDroppedAndTheMotionStaysTheSame) {
  const std::string file = Write("0");
  const ModelPtr all = LoadUnchanged(file);
  const ModelPtr model = LoadModel(file);
  EXPECT_LT(model->njmax, all->njmax / 5);
  const DataPtr expected = MakeData(*all);
  const DataPtr data = MakeData(*model);
  EXPECT_LT(data->nbuffer, expected->nbuffer / 5);
  int most = 0;
  for (int step = 0; step < 500; ++step) {
    mj_step(all.get(), expected.get());
    mj_step(model.get(), data.get());
    most = std::max(most, data->nefc);
    for (int i = 0; i < model->nq; ++i) ASSERT_EQ(data->qpos[i], expected->qpos[i]);
  }
  EXPECT_EQ(data->warning[mjWARN_CNSTRFULL].number, 0);
  // Equality constraints 6 + 3 + 1 + 1, friction 5 + 2, limits 2 + 2 + 1 + 2 + 2: room for
  // as many of each kind as that kind can have.
  EXPECT_EQ(most, 27);
  EXPECT_EQ(model->njmax, 4 * 6 + 17 + 5 * 2 + 2 * 3);
}

TEST_F(UnusedRows, StayWhereGeomsMayTouch) {
  const std::string file = Write("1");
  EXPECT_EQ(LoadModel(file)->njmax, LoadUnchanged(file)->njmax);
}

}  // namespace
}  // namespace mjdiag
