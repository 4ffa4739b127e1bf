// The diagnosis of the wire bonder against SciPy, which makes it anew from the matrices
// of the machine, here and now: see diagnosis_reference.py. What of SciPy is compared
// in tests/signals/scipy_test.cc (filter coefficients, Welch, discretisation) is taken
// as known here.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "support/bonder.h"
#include "support/scipy.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Difference;
using test::Values;
using testing::Each;
using testing::Lt;

std::string Text(const Values& values) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& [name, matrix] : values) {
    text << name << ' ' << matrix.rows() << ' ' << matrix.cols();
    for (const double value : matrix.reshaped<Eigen::RowMajor>()) text << ' ' << value;
    text << '\n';
  }
  return text.str();
}

MatrixXd Scalar(double value) { return MatrixXd::Constant(1, 1, value); }
MatrixXd Pair(double first, double second) {
  MatrixXd pair(1, 2);
  pair << first, second;
  return pair;
}

/// Coefficients of p^0, p^1, ... side by side.
MatrixXd SideBySide(const Numerators& numerators) {
  MatrixXd all(numerators.front().rows(), 0);
  for (const MatrixXd& coefficient : numerators) {
    MatrixXd longer(all.rows(), all.cols() + coefficient.cols());
    longer << all, coefficient;
    all = longer;
  }
  return all;
}

/// The numerators of which MakeFilterBank made a bank.
Numerators NumeratorsOf(const FilterBank& bank) {
  const Index n = bank.order();
  const Index m = bank.outputs();
  const double corner = bank.gain / kDeltaScale;
  Numerators numerators;
  for (Index k = 0; k < n; ++k) {
    numerators.push_back(
        std::pow(corner, static_cast<double>(n - k)) *
        (bank.B.middleRows(k * m, m) / bank.gain + bank.feedback[k] * bank.D));
  }
  numerators.push_back(bank.D);
  return numerators;
}

void AddMachine(Values& values, const std::string& prefix,
                const MechanicalModel& model) {
  values[prefix + "M"] = model.M;
  values[prefix + "D"] = model.D;
  values[prefix + "K"] = model.K;
  values[prefix + "Gamma"] = model.Gamma;
  values[prefix + "b"] = model.b;
}

MatrixXd AsRow(const Denominator& denominator) {
  return Pair(denominator.order, denominator.cutoff);
}

/// A quarter of a second with a worn x-guide: all three axes move, alone and together.
struct WornGuide {
  WornGuide()
      : machine(test::Bonder({"trajectories.multi.duration=0.25",
                              "diagnosis.estimation.magnitudes.beta_x=1e-3",
                              "diagnosis.estimation.magnitudes.beta_y=1e-3"})),
        options(SynthesisOf(machine)),
        space(MakeResidualSpace(machine.linear(), options)),
        design(DesignFilters(machine)) {
    const Record record =
        SimulateLinear(machine.With({{{"zeta_x", 1.01}}, {}}),
                       FollowTrajectory(setup, setup.trajectories.Find("multi")), {});
    signals = Signals(design, record);
    log = RecordDiagnosis(design, record).recorder.Log();
  }

  Values ForPython() const {
    Values values;
    AddMachine(values, "", machine.linear());
    const std::vector<PerturbedModels> perturbed = MakeFaultFamily(machine).Perturbed();
    MatrixXd magnitudes(1, perturbed.size());
    for (std::size_t i = 0; i < perturbed.size(); ++i) {
      AddMachine(values, "minus" + std::to_string(i) + ".", perturbed[i].minus);
      AddMachine(values, "plus" + std::to_string(i) + ".", perturbed[i].plus);
      magnitudes(0, static_cast<Index>(i)) = perturbed[i].magnitude;
    }
    values["magnitudes"] = magnitudes;
    values["step"] = Scalar(options.timing.step);
    values["substeps"] = Scalar(options.timing.substeps);
    values["delta_scale"] = Scalar(kDeltaScale);
    values["degree"] = Scalar(options.residual.degree);
    values["noise"] = VectorXd::Zero(signals.rows()).transpose();
    values["noise"].leftCols(design.sensor_noise.size()) =
        design.sensor_noise.transpose();
    values["record"] = signals;
    values["space"] = SideBySide(space.relations);
    values["space.denominator"] = AsRow(options.residual.denominator);
    values["bank"] = SideBySide(NumeratorsOf(design.bank.filters));
    values["bank.denominator"] = AsRow(options.residual.denominator);
    values["disturbance"] = SideBySide(NumeratorsOf(design.disturbance.filter));
    values["disturbance.denominator"] = AsRow(setup.diagnosis.disturbance_denominator);
    values["high_pass"] =
        Pair(setup.diagnosis.high_pass_order, setup.diagnosis.high_pass_cutoff);
    values["segment"] = Scalar(kSegment);
    return values;
  }

  static constexpr int kSegment = 512;
  Machine machine;
  const Setup& setup = machine.setup();
  SynthesisOptions options;
  ResidualSpace space;
  DiagnosisDesign design;
  MatrixXd signals;
  MonitorLog log;
};

class DiagnosisScipy : public test::ScipyTest {
 protected:
  static void SetUpTestSuite() {
    if (!HasScipy()) return;
    ours_ = new WornGuide;
    const test::TemporaryFolder folder;
    const std::string given = folder.Write("given.txt", Text(ours_->ForPython()));
    RunScript("tests/plugin/design/diagnosis_reference.py " + given);
  }
  static void TearDownTestSuite() { delete ours_; }

  static const WornGuide& Ours() { return *ours_; }

 private:
  inline static WornGuide* ours_ = nullptr;
};

TEST_F(DiagnosisScipy, FindsTheSameParityRelations) {
  // Three outputs and twenty states: none below degree 6, one of 6, four up to 7.
  const MatrixXd& nullity = Value("nullity");
  ASSERT_EQ(nullity.cols(), 8);
  const StateSpace system = DeltaForm(Ours().machine.linear(), Ours().options.timing);
  for (int degree = 0; degree <= 7; ++degree) {
    EXPECT_EQ(LeftNullSpace(system, degree).relations.rows(), nullity(0, degree))
        << degree;
  }
  EXPECT_EQ(nullity(0, 5), 0);
  EXPECT_EQ(nullity(0, 6), 1);
  EXPECT_EQ(nullity(0, 7), 4);
  EXPECT_EQ(Ours().space.relations.front().rows(), 4);
  // Rounding, times 1e4 for the spread of the singular values of the stack in the
  // coordinates of the reference, times 1e4 for that of the coefficients within a
  // power.
  EXPECT_LT(Number("angle"), 1e-7);
}

TEST_F(DiagnosisScipy, ConfirmsThatRelationsAreBlindToNominalMotion) {
  // N [G; I] at points of the complex plane, over the sum of the magnitudes of what
  // cancels in it: rounding is left, times the condition of the resolvent (1e5 and more
  // near the poles of the guides).
  EXPECT_LT(Number("space.misfit"), 1e-9);
  EXPECT_LT(Number("bank.misfit"), 1e-9);
  EXPECT_LT(Number("disturbance.misfit"), 1e-9);
}

TEST_F(DiagnosisScipy, ConfirmsThatPrefiltersAreTheDerivativesOfTheResidual) {
  // Both sides are central differences over a change of c = 1e-3 of a fault
  // parameter, but of different things: they agree up to their terms of c^2,
  // times how strongly the relation bends, which is some tens for the guide dampers. A
  // wrong derivative is off by one.
  EXPECT_THAT(Value("derivatives").reshaped(), Each(Lt(1e-3)));
}

TEST_F(DiagnosisScipy, HasTheSameDenominators) {
  for (const auto& [name, bank] :
       {std::pair{"bank", Ours().design.bank.filters},
        std::pair{"disturbance", Ours().design.disturbance.filter}}) {
    SCOPED_TRACE(name);
    EXPECT_NEAR(bank.gain, Number(std::string(name) + ".gain"), 1e-12 * bank.gain);
    // Coefficients between 1 and 11; exp(s T) - 1 loses two digits at 50 Hz.
    EXPECT_LT(
        Difference(bank.feedback.transpose(), Value(std::string(name) + ".feedback")),
        1e-11);
  }
}

TEST_F(DiagnosisScipy, ConfirmsThatRelationsHaveUnitNoise) {
  // Rounding, times 1e4 for the Lyapunov equation of poles that near to 1.
  constexpr double kRounding = 1e-11;
  const MatrixXd& covariance = Value("space.covariance");
  EXPECT_LT((covariance - MatrixXd::Identity(4, 4)).cwiseAbs().maxCoeff(), kRounding);
  const MatrixXd& bank = Value("bank.covariance");
  EXPECT_NEAR(bank(0, 0), 1.0, kRounding);
  // The noise of a prefiltered signal tells nothing about that of the residual, up to
  // the terms of c^2 of its central difference.
  for (Index i = 1; i < bank.cols(); ++i) {
    EXPECT_LE(std::abs(bank(0, i)), 1e-4 * std::sqrt(bank(i, i)))
        << Ours().design.bank.faults[static_cast<std::size_t>(i - 1)];
  }
  EXPECT_NEAR(Number("disturbance.covariance"), 1.0, kRounding);
}

TEST_F(DiagnosisScipy, RunsTheSameFiltersOverARecord) {
  // Positions of 1e5 times their noise cancel to a residual of some hundred times its
  // noise, in either form of the filters with its own rounding.
  constexpr double kRounding = 1e-8;
  const MatrixXd& reference = Value("bank.output");
  const MatrixXd outputs = FilterSignals(Ours().design.bank.filters, Ours().signals);
  for (Index i = 0; i < outputs.rows(); ++i) {
    EXPECT_LT(Difference(outputs.row(i), reference.row(i)), kRounding) << i;
  }
  EXPECT_LT(Difference(Ours().log.residual.transpose(), reference.row(0)), kRounding);
  // The worn guide is in it: many times the noise, which is one.
  EXPECT_GT(reference.row(0).cwiseAbs().maxCoeff(), 10.0);
}

TEST_F(DiagnosisScipy, HasTheSameDensityOfTheDisturbanceResidual) {
  // As above, of a residual no larger than its noise.
  constexpr double kRounding = 1e-7;
  const VectorXd& ours = Ours().log.disturbance;
  EXPECT_LT(Difference(ours.transpose(), Value("high_passed")), kRounding);
  const Spectrum spectrum =
      WelchDensity(ours, Ours().setup.rates.tick(), WornGuide::kSegment);
  EXPECT_LT(Difference(spectrum.frequency.transpose(), Value("density").row(0)), 1e-14);
  EXPECT_LT(Difference(spectrum.density.transpose(), Value("density").row(1)),
            kRounding);
}

}  // namespace
}  // namespace mjdiag
