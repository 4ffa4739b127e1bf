#include "mjdiag/studies/excitation/inertial_regressor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// MuJoCo's own inverse dynamics, without constraints, and the friction of the joints.
VectorXd ForceOf(const mjModel& model, const VectorXd& q, const VectorXd& v,
                 const VectorXd& a) {
  const DataPtr data = MakeData(model);
  VectorXd::Map(data->qpos, model.nq) = q;
  VectorXd::Map(data->qvel, model.nv) = v;
  VectorXd::Map(data->qacc, model.nv) = a;
  mj_fwdPosition(&model, data.get());
  mj_fwdVelocity(&model, data.get());
  VectorXd force(model.nv), rotor(model.nv);
  mj_rne(&model, data.get(), 1, force.data());
  for (Eigen::Index i = 0; i < model.nv; ++i) {
    rotor[i] = model.dof_armature[i] * a[i] + model.dof_damping[i] * v[i] +
               model.dof_frictionloss[i] * (v[i] > 0.0 ? 1.0 : -1.0);
  }
  return force + rotor;
}

class ArmRegressor : public ::testing::Test {
 protected:
  ModelPtr Arm() const {
    ModelPtr arm =
        CopyModel(Machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/panda")).plant());
    for (int i = 0; i < arm->nv; ++i) {
      arm->dof_armature[i] = 0.1 + 0.01 * i;
      arm->dof_damping[i] = 0.3;
      arm->dof_frictionloss[i] = 0.2 * i;
    }
    return arm;
  }
};

TEST_F(ArmRegressor, GivesTheForcesOfTheInverseDynamics) {
  const ModelPtr arm = Arm();
  InertialRegressor regressor(*arm);
  EXPECT_EQ(regressor.numbers(), 7 * 13);
  const VectorXd values = regressor.Values();
  std::srand(1);
  for (int trial = 0; trial < 20; ++trial) {
    const VectorXd q = VectorXd::Random(7), v = VectorXd::Random(7) * 3.0,
                   a = VectorXd::Random(7) * 10.0;
    const VectorXd force = ForceOf(*arm, q, v, a);
    EXPECT_LT((regressor.At(q, v, a) * values - force).norm(), 1e-11 * force.norm());
  }
}

TEST_F(ArmRegressor, RefusesAJointThatIsNeitherHingeNorSlide) {
  char error[200] = "";
  constexpr const char* kFree =
      "<mujoco><worldbody><body><freejoint name='loose'/><geom size='1'/></body>"
      "</worldbody></mujoco>";
  mjVFS vfs;
  mj_defaultVFS(&vfs);
  mj_makeEmptyFileVFS(&vfs, "free.xml", static_cast<int>(strlen(kFree)));
  memcpy(vfs.filedata[0], kFree, strlen(kFree));
  const ModelPtr model(mj_loadXML("free.xml", &vfs, error, sizeof error));
  mj_deleteVFS(&vfs);
  ASSERT_TRUE(model) << error;
  EXPECT_THAT([&] { InertialRegressor{*model}; },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("loose")));
}

}  // namespace
}  // namespace mjdiag
