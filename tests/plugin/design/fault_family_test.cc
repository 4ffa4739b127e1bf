#include "mjdiag/plugin/design/fault_family.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAreArray;

MechanicalModel Faulty(const Machine& machine, const std::vector<Fault>& faults) {
  return machine.With({faults, {}}).linear();
}

std::vector<Fault> At(const std::vector<std::string>& names, const VectorXd& values) {
  std::vector<Fault> faults;
  for (std::size_t i = 0; i < names.size(); ++i) {
    faults.push_back({names[i], values[static_cast<Index>(i)]});
  }
  return faults;
}

Index PlaceOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) - names.begin();
}

/// Entries "<matrix>(<row>,<column>)" that differ by more than rounding.
std::vector<std::string> Changes(const MechanicalModel& from,
                                 const MechanicalModel& to) {
  std::vector<std::string> changes;
  const auto compare = [&](const std::string& name, const MatrixXd& a,
                           const MatrixXd& b, const std::vector<std::string>& columns) {
    const double rounding = 1e-13 * a.cwiseAbs().maxCoeff();
    for (Index i = 0; i < a.rows(); ++i) {
      for (Index j = 0; j < a.cols(); ++j) {
        if (std::abs(a(i, j) - b(i, j)) <= rounding) continue;
        changes.push_back(name + "(" + from.coordinates[i] + "," + columns[j] + ")");
      }
    }
  };
  compare("M", from.M, to.M, from.coordinates);
  compare("D", from.D, to.D, from.coordinates);
  compare("K", from.K, to.K, from.coordinates);
  compare("Gamma", from.Gamma, to.Gamma, from.inputs);
  compare("b", from.b, to.b, from.outputs);
  return changes;
}

/// Names of the entries of a column of Gamma that are more than rounding.
std::vector<std::string> Driven(const MechanicalModel& model,
                                const std::string& input) {
  std::vector<std::string> entries;
  const Index column = PlaceOf(model.inputs, input);
  const double rounding = 1e-9 * model.Gamma.col(column).cwiseAbs().maxCoeff();
  for (Index i = 0; i < model.Gamma.rows(); ++i) {
    if (std::abs(model.Gamma(i, column)) <= rounding) continue;
    entries.push_back("Gamma(" + model.coordinates[i] + "," + input + ")");
  }
  return entries;
}

TEST(FaultyMachine, ScalesTheEntriesOfTheParameterAndNothingElse) {
  const Machine machine = test::Bonder();
  const MechanicalModel& healthy = machine.linear();
  const std::vector<std::pair<std::string, std::vector<std::string>>> expected = {
      {"zeta_x", {"D(X,X)"}},
      {"zeta_y", {"D(Y,Y)"}},
      {"beta_x", {"K(u3,u3)", "K(r2,r2)"}},
      {"beta_y", {"K(u4,u4)", "K(r3,r3)"}},
      {"eta_x", Driven(healthy, "u_x")},
      {"eta_y", Driven(healthy, "u_y")},
      {"eta_z", Driven(healthy, "u_z")}};
  for (const auto& [parameter, entries] : expected) {
    const MechanicalModel faulty = Faulty(machine, {{parameter, 0.97}});
    EXPECT_THAT(Changes(healthy, faulty), UnorderedElementsAreArray(entries))
        << parameter;
  }
  const std::vector<std::string> names = MakeFaultFamily(machine).parameters;
  EXPECT_THAT(Changes(healthy, Faulty(machine, At(names, VectorXd::Ones(7)))),
              testing::IsEmpty());
}

TEST(FaultyMachine, ScalesByTheValueOfTheParameter) {
  const Machine machine = test::Bonder();
  const MechanicalModel& healthy = machine.linear();
  const MechanicalModel faulty =
      Faulty(machine, {{"zeta_y", 1.25}, {"beta_x", 0.5}, {"eta_z", 0.75}});
  const Index y = PlaceOf(healthy.coordinates, "Y");
  const Index u3 = PlaceOf(healthy.coordinates, "u3");
  const Index u_z = PlaceOf(healthy.inputs, "u_z");
  EXPECT_DOUBLE_EQ(faulty.D(y, y), 1.25 * healthy.D(y, y));
  // Gravity adds to the springs what is far below their rounding here.
  EXPECT_NEAR(faulty.K(u3, u3), 0.5 * healthy.K(u3, u3), 1e-9 * healthy.K(u3, u3));
  EXPECT_TRUE(faulty.Gamma.col(u_z).isApprox(0.75 * healthy.Gamma.col(u_z), 1e-14));
}

TEST(FaultFamily, HasTheFaultParametersOfThePlantAndThenTheDisturbances) {
  const FaultFamily family = MakeFaultFamily(test::Bonder());
  EXPECT_THAT(family.parameters, ElementsAre("zeta_x", "zeta_y", "beta_x", "beta_y",
                                             "eta_x", "eta_y", "eta_z"));
  EXPECT_THAT(family.Names(), ElementsAre("zeta_x", "zeta_y", "beta_x", "beta_y",
                                          "eta_x", "eta_y", "eta_z", "gamma"));
}

TEST(FaultFamily, HasTheMagnitudesOfTheSetupOrOneThousandth) {
  const Machine machine =
      test::Bonder({"diagnosis.estimation.magnitudes={ eta_y = 1e-5, beta_x = 0.02, "
                    "beta_y = 0.03 }"});
  EXPECT_THAT(MakeFaultFamily(machine).magnitudes,
              ElementsAre(1e-3, 1e-3, 0.02, 0.03, 1e-3, 1e-5, 1e-3));
}

TEST(FaultFamily, ListsTheParametersThatThereAreIfAMagnitudeIsOfNone) {
  const Machine machine = test::Bonder({"diagnosis.estimation.magnitudes.zeta_q=0.01"});
  const auto expected =
      AllOf(HasSubstr("diagnosis.estimation.magnitudes"),
            HasSubstr("no fault parameter 'zeta_q'"),
            HasSubstr("one of zeta_x, zeta_y, beta_x, beta_y, eta_x, eta_y, eta_z"));
  EXPECT_THAT(test::MessageOf<InputError>([&] { MakeFaultFamily(machine); }), expected);
}

void ExpectSameModel(const MechanicalModel& actual, const MechanicalModel& expected) {
  EXPECT_THAT(Changes(expected, actual), testing::IsEmpty());
  EXPECT_EQ(actual.coordinates, expected.coordinates);
  EXPECT_EQ(actual.inputs, expected.inputs);
  EXPECT_EQ(actual.outputs, expected.outputs);
}

TEST(FaultFamily, TurnsOneParameterAtATimeBothWays) {
  const Machine machine = test::Bonder({"diagnosis.estimation.magnitudes.beta_y=0.05"});
  const FaultFamily family = MakeFaultFamily(machine);
  const std::vector<PerturbedModels> perturbed = family.Perturbed();
  const std::vector<std::string>& names = family.parameters;
  ASSERT_EQ(perturbed.size(), names.size());
  for (std::size_t i = 0; i < perturbed.size(); ++i) {
    SCOPED_TRACE(names[i]);
    const double c = family.magnitudes[static_cast<Index>(i)];
    EXPECT_EQ(perturbed[i].name, names[i]);
    EXPECT_EQ(perturbed[i].magnitude, c);
    ExpectSameModel(perturbed[i].minus, Faulty(machine, {{names[i], 1.0 - c}}));
    ExpectSameModel(perturbed[i].plus, Faulty(machine, {{names[i], 1.0 + c}}));
  }
}

TEST(FaultFamily, HasTheModelsOfThePlantWithTheParametersChanged) {
  const Machine machine = test::Bonder();
  const FaultFamily family = MakeFaultFamily(machine);
  const VectorXd ones = VectorXd::Ones(7);
  VectorXd far(7);
  far << 1.7, 0.3, 0.5, 1.4, 0.9, 1.1, 0.2;
  for (const VectorXd& values : {ones, far}) {
    ExpectSameModel(family.model_at(values),
                    Faulty(machine, At(family.parameters, values)));
  }
}

/// A pendulum that a spring holds out of the vertical: a weaker spring lets it down,
/// and with the angle the stiffness of gravity changes.
class Pendulum : public testing::Test {
 protected:
  Pendulum() {
    folder_.Write("plant.xml", R"(<mujoco><option timestep="0.001"/>
  <custom><text name="fault.beta" data="stiffness hinge"/></custom>
  <worldbody><body><joint name="hinge" type="hinge" axis="0 1 0" damping="0.1"
      stiffness="30" springref="60"/>
    <inertial pos="0 0 -1" mass="2" diaginertia="0.1 0.1 0.1"/></body></worldbody>
  <actuator><motor name="motor" joint="hinge"/></actuator>
  <sensor><jointpos name="encoder" joint="hinge"/></sensor></mujoco>)");
    folder_.Write("setup.toml", R"(schema = "mjdiag.setup/1"
name = "pendulum"
plant = "plant.xml"
rates = { control = 1000.0 }
sensors.q = { element = "encoder", unit = "rad" }
actuators.u = { element = "motor", unit = "N m" }
)");
  }
  Machine Load() const {
    return Machine(ReadSetup(
        folder_.path(), {"diagnosis.cutoff=50", "diagnosis.disturbance.cutoff=300"}));
  }
  const test::TemporaryFolder folder_;
};

TEST_F(Pendulum, HasModelsAboutTheEquilibriumThatTheParameterMovesItTo) {
  const Machine machine = Load();
  const FaultFamily family = MakeFaultFamily(machine);
  const MechanicalModel& healthy = machine.linear();
  for (const double beta : {1.0, 0.8, 0.4}) {
    SCOPED_TRACE(beta);
    const MechanicalModel model = family.model_at(VectorXd::Constant(1, beta));
    ExpectSameModel(model, Faulty(machine, {{"beta", beta}}));
    // K = beta k + m g l cos(angle): what gravity adds has grown as the arm came down.
    const double gravity = model.K(0, 0) - 30.0 * beta;
    const double before = healthy.K(0, 0) - 30.0;
    EXPECT_GE(gravity, before + (beta < 1.0 ? 0.1 : 0.0));
  }
}

TEST(FaultFamily, HasTheDisturbancesOnTheActuatorsInTheOrderOfTheSetup) {
  const std::vector<Multisine> sines = MakeFaultFamily(test::Bonder()).disturbances;
  ASSERT_EQ(sines.size(), 1);
  EXPECT_EQ(sines[0].name, "gamma");
  EXPECT_THAT(sines[0].frequencies, ElementsAre(100.0, 300.0, 750.0));
  // ratio * maximum of u_x, u_y, u_z
  EXPECT_THAT(sines[0].amplitude,
              ElementsAre(testing::DoubleEq(4.5), testing::DoubleEq(2.0),
                          testing::DoubleEq(0.001)));
}

}  // namespace
}  // namespace mjdiag
