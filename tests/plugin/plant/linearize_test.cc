#include "mjdiag/plugin/plant/linearize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/diagnosis/model/linear_chain.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/transition.h"
#include "mjdiag/plugin/setup/chain_file.h"
#include "mjdiag/plugin/setup/published_relation_file.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

const std::string kBonder = std::string(MJDIAG_SOURCE_DIR) + "/mjcf/ab383/";

const Machine& Bonder() {
  static const Machine machine = test::Bonder();
  return machine;
}

/// A plant with the bonder's channels, about its own rest.
MechanicalModel LinearBonder(const mjModel& plant) {
  return Linearize(plant, Bonder().channels(), FindRest(plant).qpos);
}

MechanicalModel LinearBonder() { return LinearBonder(Bonder().plant()); }

StateSpace TickOfMujoco(const Machine& machine, int substeps) {
  const OperatingPoint rest =
      HeldAt(machine.plant(), machine.channels(), machine.rest_pose());
  return TransitionAbout(machine.plant(), machine.channels(), rest, substeps).tick;
}

const MechanicalModel& Analytic() {
  static const MechanicalModel model =
      Linearize(ReadLinearChain(kBonder + "analytic.toml"));
  return model;
}

double Relative(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

/// Largest |a_ij - b_ij| / (row_i column_j): every entry on its own scale.
double Scaled(const MatrixXd& a, const MatrixXd& b, const VectorXd& rows,
              const VectorXd& columns) {
  return (rows.cwiseInverse().asDiagonal() * (a - b) *
          columns.cwiseInverse().asDiagonal())
      .cwiseAbs()
      .maxCoeff();
}

/// How far two models are apart, entry by entry. M on sqrt(M_ii M_jj), D and K the same
/// (a coordinate without spring or damper: on the mass and 1 rad/s), Gamma and b on
/// the displacement that the coordinate makes at a lever of 1 mm at least.
double ElementwiseDifference(const MechanicalModel& a, const MechanicalModel& b) {
  const auto scale = [&](const MatrixXd& matrix) -> VectorXd {
    return matrix.diagonal()
        .cwiseAbs()
        .binaryExpr(b.M.diagonal(),
                    [](double own, double mass) { return own > 0.0 ? own : mass; })
        .cwiseSqrt();
  };
  VectorXd lever = VectorXd::Ones(b.M.rows());
  for (std::size_t i = 0; i < b.coordinates.size(); ++i) {
    if (b.coordinates[i][0] == 'r') lever[static_cast<Eigen::Index>(i)] = 1e-3;
  }
  const VectorXd channels = VectorXd::Ones(b.Gamma.cols());
  return std::max({Scaled(a.M, b.M, scale(b.M), scale(b.M)),
                   Scaled(a.D, b.D, scale(b.D), scale(b.D)),
                   Scaled(a.K, b.K, scale(b.K), scale(b.K)),
                   Scaled(a.Gamma, b.Gamma, lever, channels),
                   Scaled(a.b, b.b, lever, channels)});
}

TEST(Linearize, BonderIsTheAnalyticModelInNorm) {
  const MechanicalModel model = LinearBonder();
  EXPECT_EQ(model.coordinates, Analytic().coordinates);
  EXPECT_EQ(model.inputs, Analytic().inputs);
  EXPECT_EQ(model.outputs, Analytic().outputs);
  EXPECT_LT(Relative(model.M, Analytic().M), 1e-9);
  EXPECT_LT(Relative(model.D, Analytic().D), 1e-9);
  EXPECT_LT(Relative(model.K, Analytic().K), 1e-9);
  EXPECT_LT(Relative(model.Gamma, Analytic().Gamma), 1e-9);
  EXPECT_LT(Relative(model.b, Analytic().b), 1e-9);
}

TEST(Linearize, BonderIsTheAnalyticModelEntryByEntry) {
  EXPECT_LT(ElementwiseDifference(LinearBonder(), Analytic()), 1e-9);
}

TEST(Linearize, BonderHasTheRecoveredEntries) {
  // Spot checks against the recovered parameters themselves, so that the two models
  // cannot drift together.
  const MechanicalModel model = LinearBonder();
  EXPECT_NEAR(model.M(0, 0), 311.7715591307104, 1e-9);
  EXPECT_NEAR(model.M(2, 2), 21.906616071379435, 1e-10);
  EXPECT_NEAR(model.M(8, 8), 0.003922618363166893, 1e-14);
  EXPECT_NEAR(model.M(8, 9), 5.850195646907073e-07, 1e-17);
  EXPECT_NEAR(model.M(9, 9), 0.00016682774917447894, 1e-15);
  EXPECT_NEAR(model.K(9, 9), 1.4724830385896046, 1e-11);
  EXPECT_NEAR(model.K(4, 4), 278831270.7689545, 1e-3);
  EXPECT_NEAR(model.D(3, 3), 115.97571401384852, 1e-10);
  EXPECT_NEAR(model.Gamma(5, 1), 0.020914980015845516, 1e-12);
  EXPECT_NEAR(model.b(8, 1), 0.025001362903129667, 1e-12);
}

/// One number of a compiled plant.
struct Parameter {
  std::string name;
  std::function<mjtNum*(mjModel&)> of;
};

/// Everything of the bonder that its linear model depends on. Heights do not count, nor
/// inertias about horizontal axes except the arm's, nor where along its line a scale or
/// stator is fixed.
std::vector<Parameter> PhysicalParameters(mjModel& bonder) {
  std::vector<Parameter> parameters;
  const auto add = [&](const std::string& name, mjtNum* mjModel::*array, int index) {
    if ((bonder.*array)[index] == 0.0) return;
    parameters.push_back({name, [=](mjModel& model) { return model.*array + index; }});
  };
  for (int joint = 0; joint < bonder.njnt; ++joint) {
    const std::string name = ElementName(bonder, mjOBJ_JOINT, joint);
    add(name + " stiffness", &mjModel::jnt_stiffness, joint);
    add(name + " spring reference", &mjModel::qpos_spring, joint);
    add(name + " damping", &mjModel::dof_damping, joint);
  }
  const std::string axes = "xy";
  for (int body = 1; body < bonder.nbody; ++body) {
    const std::string name = ElementName(bonder, mjOBJ_BODY, body);
    add(name + " mass", &mjModel::body_mass, body);
    add(name + " inertia z", &mjModel::body_inertia, 3 * body + 2);
    for (int axis = 0; axis < 2; ++axis) {
      add(name + " centre " + axes[axis], &mjModel::body_ipos, 3 * body + axis);
      add(name + " place " + axes[axis], &mjModel::body_pos, 3 * body + axis);
    }
  }
  const int arm = FindElement(bonder, mjOBJ_BODY, "arm");
  add("arm inertia x", &mjModel::body_inertia, 3 * arm);
  add("arm centre z", &mjModel::body_ipos, 3 * arm + 2);
  for (int i = 0; i < 6 * bonder.nu; ++i) {
    add(ElementName(bonder, mjOBJ_ACTUATOR, i / 6) + " gear", &mjModel::actuator_gear,
        i);
  }
  for (const auto& [site, axis] : {std::pair{"x_coil", 1}, std::pair{"y_coil", 0},
                                   std::pair{"x_head", 1}, std::pair{"y_head", 0}}) {
    add(site, &mjModel::site_pos, 3 * FindElement(bonder, mjOBJ_SITE, site) + axis);
  }
  parameters.push_back(
      {"gravity", [](mjModel& model) { return model.opt.gravity + 2; }});
  return parameters;
}

TEST(Linearize, ADriftOfAThousandthInAnyParameterIsNoticed) {
  const ModelPtr bonder = CopyModel(Bonder().plant());
  const std::vector<Parameter> parameters = PhysicalParameters(*bonder);
  // 8 springs, 10 dampers, a preload, 4 masses, 5 inertias, 14 offsets of bodies and
  // centres, 3 gears, 4 sites, gravity.
  EXPECT_EQ(parameters.size(), 50u);
  for (const Parameter& parameter : parameters) {
    const ModelPtr drifted = CopyModel(*bonder);
    *parameter.of(*drifted) *= 1.001;
    const double difference = ElementwiseDifference(LinearBonder(*drifted), Analytic());
    EXPECT_GT(difference, 1e-8) << parameter.name;
  }
}

TEST(Linearize, BonderHasTheRecoveredModes) {
  const std::vector<std::pair<double, double>> expected = {
      {5.39918908329904, 1.0},
      {6.08832324336308, 1.0},
      {14.972660358824387, 0.10105556738148709},
      {91.6598634269506, 0.1709611202300374},
      {93.85337066827842, 0.17509119487365377},
      {117.32009665329109, 0.2184635521602586},
      {980.9225252481779, 0.031927865703997346},
      {2038.5705802120367, 0.04604403319215007},
      {2262.769151806461, 0.05525516102722934},
      {2952.555986161789, 0.07095760350867782}};
  const std::vector<Mode> modes = Modes(LinearBonder());
  ASSERT_EQ(modes.size(), expected.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    EXPECT_NEAR(modes[i].frequency / expected[i].first, 1.0, 1e-9);
    EXPECT_NEAR(modes[i].damping_ratio / expected[i].second, 1.0, 1e-9);
  }
}

TEST(Linearize, BonderReproducesEveryPrintedCoefficient) {
  const PublishedRelationComparison comparison = ComparePublishedRelation(
      LinearBonder(), ReadPublishedRelation(kBonder + "published_row.toml"));
  EXPECT_EQ(comparison.coefficients.size(), 35u);
  for (const CoefficientComparison& c : comparison.coefficients) {
    EXPECT_LT(c.half_ulps, 2.0) << c.channel << " s^" << c.power;
  }
  EXPECT_NEAR(comparison.worst_half_ulp, 0.59, 0.01);
}

TEST(Linearize, BonderOnePercentOffMissesThePrint) {
  const ModelPtr bonder = CopyModel(Bonder().plant());
  const int y_stage = FindElement(*bonder, mjOBJ_BODY, "y_stage");
  bonder->body_mass[y_stage] *= 1.01;
  EXPECT_GT(
      ComparePublishedRelation(LinearBonder(*bonder),
                               ReadPublishedRelation(kBonder + "published_row.toml"))
          .worst_half_ulp,
      2.0);
}

TEST(Linearize, BonderIsSeenAfterSevenDerivatives) {
  const MechanicalModel model = LinearBonder();
  EXPECT_EQ(ObservabilityRanks(UnitMassStateSpace(model, FastTimeUnit(model)), 7),
            (std::vector<int>{3, 6, 9, 12, 15, 18, 20, 20}));
}

TEST(Linearize, TickModelIsMujocosOwnStep) {
  const Machine& bonder = Bonder();
  const int substeps = bonder.rates().substeps;
  const StateSpace exact =
      TickModel(LinearBonder(), bonder.plant().opt.timestep, substeps);
  const StateSpace differences = TickOfMujoco(bonder, substeps);
  EXPECT_LT(Relative(exact.A, differences.A), 1e-8);
  EXPECT_LT(Relative(exact.B, differences.B), 1e-8);
  EXPECT_LT(Relative(exact.C, differences.C), 1e-8);
}

TEST(Linearize, EncodersReadZeroAtRest) {
  const mjModel& bonder = Bonder().plant();
  const DataPtr data = MakeData(bonder);
  mj_forward(&bonder, data.get());
  for (int i = 0; i < bonder.nsensordata; ++i) {
    EXPECT_NEAR(data->sensordata[i], 0.0, 1e-16);
  }
}

TEST(Linearize, LeavesTheControlCallbackAlone) {
  static int calls = 0;
  const Machine& bonder = Bonder();  // before: MuJoCo's compiler runs a step
  mjcb_control = [](const mjModel*, mjData* data) {
    ++calls;
    data->ctrl[0] = 1e6;
  };
  const mjfGeneric installed = mjcb_control;
  const MechanicalModel model = LinearBonder();
  TickOfMujoco(bonder, 4);
  EXPECT_EQ(mjcb_control, installed);
  mjcb_control = nullptr;
  EXPECT_EQ(calls, 0);
  EXPECT_LT(Relative(model.Gamma, Analytic().Gamma), 1e-9);
}

/// A small model from text.
ModelPtr FromText(const std::string& name, const std::string& xml) {
  const test::TemporaryFolder folder;
  return LoadModel(folder.Write(name + ".xml", xml));
}

TEST(Linearize, OfASaggingPendulumHasTheStiffnessOfSpringAndWeight) {
  const ModelPtr model = FromText("sagging", R"(<mujoco><compiler angle="radian"/>
    <worldbody><body><joint type="hinge" axis="0 1 0" stiffness="1"/>
      <inertial pos="0.2 0 0" mass="2" diaginertia="1e-3 1e-3 1e-3"/>
    </body></worldbody></mujoco>)");
  const VectorXd rest = FindRest(*model).qpos;
  const double stiffness = 1.0 + 2.0 * 9.81 * 0.2 * std::sin(rest[0]);
  EXPECT_NEAR(Linearize(*model, {}, rest).K(0, 0) / stiffness, 1.0, 1e-12);
}

/// What methods refuse that know slides and hinges only.
std::string Refusal(const mjModel& model, const Channels& channels) {
  try {
    RequireScalarJoints(model, channels);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RequireScalarJoints, NamesAJointThatIsNoSlideOrHinge) {
  const ModelPtr model = FromText("free", R"(<mujoco><worldbody><body>
      <freejoint name="loose"/><inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>
    </body></worldbody></mujoco>)");
  EXPECT_NE(Refusal(*model, {}).find("joint loose"), std::string::npos);
}

TEST(RequireScalarJoints, NamesASensorThatDoesNotReadAPosition) {
  const ModelPtr model = FromText("velocity", R"(<mujoco><worldbody><body>
      <joint type="slide" axis="1 0 0" name="x"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>
    </body></worldbody><sensor><jointvel name="speed" joint="x"/></sensor></mujoco>)");
  Channels channels;
  channels.sensors = {{"v", "speed", 0, "m/s"}};
  EXPECT_NE(Refusal(*model, channels).find("sensor speed"), std::string::npos);
}

}  // namespace
}  // namespace mjdiag
