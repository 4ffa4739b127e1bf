// A number that is scaled in a loaded model is the number of the MJCF.

#include "mjdiag/plugin/plant/scale_number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <sstream>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "support/count_allocations.h"
#include "support/message_of.h"
#include "support/numbered_plant.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;
using test::MessageOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kFactor = 1.07;

/// "a b c", every one `factor` times as large and `shift` further.
std::string Changed(const std::string& numbers, double factor, double shift) {
  std::istringstream words(numbers);
  std::string text;
  for (double value = 0.0; words >> value;) {
    text += (text.empty() ? "" : " ") + AllDigits(value * factor + shift);
  }
  return text;
}

/// Positions and velocities of a swing from where the plant is drawn, with all that MuJoCo
/// knows of its constants.
VectorXd Swing(const mjModel& model) {
  constexpr int kSteps = 300;
  const DataPtr data = MakeData(model);
  VectorXd all(kSteps * 2 * model.nv);
  for (int k = 0; k < kSteps; ++k) {
    for (int u = 0; u < model.nu; ++u) data->ctrl[u] = 0.4 + 0.3 * std::sin(0.05 * k);
    mj_step(&model, data.get());
    all.segment(2 * model.nv * k, model.nv) = VectorXd::Map(data->qpos, model.nv);
    all.segment(2 * model.nv * k + model.nv, model.nv) =
        VectorXd::Map(data->qvel, model.nv);
  }
  return all;
}

VectorXd Constants(const mjModel& model) {
  const auto nv = model.nv;
  VectorXd all(3 * nv + 2 * model.nbody + 4 * model.ntendon + model.nu + 1);
  all << VectorXd::Map(model.qpos0, nv), VectorXd::Map(model.dof_M0, nv),
      VectorXd::Map(model.dof_invweight0, nv),
      VectorXd::Map(model.body_invweight0, 2 * model.nbody),
      VectorXd::Map(model.tendon_lengthspring, model.ntendon),
      VectorXd::Map(model.tendon_length0, model.ntendon),
      VectorXd::Map(model.tendon_invweight0, model.ntendon),
      VectorXd::Map(model.tendon_stiffness, model.ntendon),
      VectorXd::Map(model.actuator_acc0, model.nu), model.stat.meaninertia;
  return all;
}

double Difference(const VectorXd& a, const VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(ScaleNumbers, GivesWhatLoadingTheMjcfWithTheOtherNumberDoes) {
  const ModelPtr nominal = test::SmallPlant(test::NumberedMjcf());
  const VectorXd as_it_is = Swing(*nominal);
  for (const auto& [name, value] : test::kNumberedValues) {
    const ModelParameter number = FindModelParameter(*nominal, name);
    const bool additive = IsAdditive(number.kind);
    const double shift = additive ? std::log(kFactor) * UnitOf(*nominal, number) : 0.0;
    test::MjcfValues other = test::kNumberedValues;
    other[name] = Changed(value, additive ? 1.0 : kFactor, shift);
    const ModelPtr loaded = test::SmallPlant(test::NumberedMjcf(other));
    const ModelPtr scaled = CopyModel(*nominal);
    ScaleNumbers(*scaled, {{number, kFactor}});
    EXPECT_LT(Difference(Constants(*scaled), Constants(*loaded)), 1e-12) << name;
    EXPECT_LT(Difference(Swing(*scaled), Swing(*loaded)), 1e-12) << name;
    EXPECT_GT(Difference(Swing(*scaled), as_it_is), 1e-6) << name;
  }
}

TEST(SetNumber, GoesThereFromAnywhereAndDoesNotAllocate) {
  const ModelPtr nominal = test::SmallPlant(test::NumberedMjcf());
  const VectorXd as_it_is = Swing(*nominal);
  for (const auto& [name, value] : test::kNumberedValues) {
    const ModelParameter number = FindModelParameter(*nominal, name);
    const ModelPtr model = CopyModel(*nominal);
    const long allocations = test::CountAllocations([&] {
      SetNumber(*model, *nominal, number, IsAdditive(number.kind) ? 2.0 : 0.0);
      SetNumber(*model, *nominal, number, 1.0);
    });
    EXPECT_EQ(allocations, 0) << name;
    EXPECT_EQ(Difference(Swing(*model), as_it_is), 0.0) << name;
  }
}

TEST(FactorFor, MakesItTheValueThatIsAskedFor) {
  const ModelPtr nominal = test::SmallPlant(test::NumberedMjcf());
  for (const auto& [name, value] :
       std::map<std::string, double>{{"mass@fore", 2.5},
                                     {"inertia@fore", 0.05},
                                     {"gear@push", 0.3},
                                     {"kp@servo", 13.0},
                                     {"kv@drive", 2.0},
                                     {"tendon_friction@rope", 0.0},
                                     {"centre_z@fore", -0.2},
                                     {"ref@slide", -0.1}}) {
    const ModelPtr model = CopyModel(*nominal);
    const ModelParameter number = FindModelParameter(*model, name);
    ScaleNumbers(*model, {{number, FactorFor(*model, number, value)}});
    EXPECT_NEAR(ValueOf(*model, number), value, 1e-12) << name;
  }
  const auto factor = [&](const std::string& name, double value) {
    return FactorFor(*nominal, FindModelParameter(*nominal, name), value);
  };
  EXPECT_THAT(MessageOf<InputError>([&] { factor("friction@elbow", 1.0); }),
              AllOf(HasSubstr("friction@elbow"), HasSubstr("0 in the plant")));
  EXPECT_THAT(MessageOf<InputError>([&] { factor("mass@fore", -1.0); }),
              HasSubstr("same sign"));
}

// The file says how large the plant is, and what is measured of it does not.
TEST(ScaleNumbers, KeepsTheStatisticsOfTheFile) {
  const ModelPtr model = test::SmallPlant(
      test::NumberedMjcf(test::kNumberedValues, "<statistic extent=\"3\"/>"));
  ScaleNumbers(*model, {{FindModelParameter(*model, "mass@fore"), 2.0}});
  EXPECT_EQ(model->stat.extent, 3.0);
}

}  // namespace
}  // namespace mjdiag
