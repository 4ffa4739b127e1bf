#include "mjdiag/diagnosis/model/delta_form.h"

#include <gtest/gtest.h>

#include "diagnosis/test_stage.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

/// From p back to the shift: z = 1 + kDeltaScale p.
StateSpace ShiftForm(StateSpace delta) {
  delta.A = MatrixXd::Identity(delta.states(), delta.states()) + kDeltaScale * delta.A;
  delta.B *= kDeltaScale;
  return delta;
}

TEST(DeltaForm, RespondsAsTheTickModel) {
  const MechanicalModel model = test::Stage();
  const MatrixXd commands = test::Drive(4000);
  const MatrixXd expected = test::Motion(model, commands).topRows(2);
  const MatrixXd response =
      SimulateLti(ShiftForm(DeltaForm(model, test::kTiming)), commands);
  EXPECT_LT((response - expected).cwiseAbs().maxCoeff(),
            1e-11 * expected.cwiseAbs().maxCoeff());
}

TEST(DeltaForm, HasEntriesOfOrderOneOrLess) {
  const StateSpace delta = DeltaForm(test::Stage(), test::kTiming);
  EXPECT_LT(delta.A.cwiseAbs().maxCoeff(), 2.5);
  EXPECT_DOUBLE_EQ(delta.sample_time, 1.0 / 8000.0);
}

TEST(HeldForces, EnterAsAnActuatorWould) {
  const MechanicalModel model = test::Stage();
  const SignalEntry entry = HeldForces(model, test::kTiming, model.Gamma);
  EXPECT_EQ(entry.B, DeltaForm(model, test::kTiming).B);
  EXPECT_EQ(entry.D, MatrixXd::Zero(2, 2));
}

TEST(HeldForces, RefuseForcesOnOtherCoordinates) {
  EXPECT_THROW(HeldForces(test::Stage(), test::kTiming, MatrixXd::Ones(4, 1)),
               InputError);
}

}  // namespace
}  // namespace mjdiag
