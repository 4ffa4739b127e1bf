// Against SciPy, which runs here and now: no stored numbers that could be our own.

#include "support/scipy.h"

#include <gtest/gtest.h>

#include <string>

#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/derivative.h"
#include "mjdiag/signals/simulate_lti.h"
#include "mjdiag/signals/spectrum.h"
#include "mjdiag/signals/zero_phase.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Difference;

class Scipy : public test::ScipyTest {
 protected:
  static void SetUpTestSuite() {
    if (HasScipy()) RunScript("tests/signals/scipy_reference.py");
  }
  static VectorXd Row(const std::string& name, Eigen::Index row = 0) {
    return Value(name).row(row);
  }
  static StateSpace System(const std::string& prefix, double sample_time) {
    return {Value(prefix + "A"), Value(prefix + "B"), Value(prefix + "C"),
            Value(prefix + "D"), sample_time};
  }
};

/// Numerator and denominator (two rows) of the whole filter.
MatrixXd Multiply(const SecondOrderSections& sections, Eigen::Index order) {
  MatrixXd product = MatrixXd::Zero(2, 2 * sections.size() + 1);
  product.col(0).setOnes();
  for (const SecondOrderSection& section : sections) {
    for (Eigen::Index k = product.cols() - 1; k >= 0; --k) {
      const double x1 = k > 0 ? product(0, k - 1) : 0.0;
      const double x2 = k > 1 ? product(0, k - 2) : 0.0;
      const double y1 = k > 0 ? product(1, k - 1) : 0.0;
      const double y2 = k > 1 ? product(1, k - 2) : 0.0;
      product(0, k) = section.b0 * product(0, k) + section.b1 * x1 + section.b2 * x2;
      product(1, k) += section.a1 * y1 + section.a2 * y2;
    }
  }
  return product.leftCols(order + 1);
}

struct ButterworthCase {
  FilterKind kind;
  int order;
  double cutoff;
  double rate;
};

ButterworthCase ReadCase(const VectorXd& values) {
  return {values[0] > 0.0 ? FilterKind::kHighPass : FilterKind::kLowPass,
          static_cast<int>(values[1]), values[2], values[3]};
}

TEST_F(Scipy, AgreesOnButterworthFilters) {
  const int cases = static_cast<int>(Value("butter.cases")(0, 0));
  for (int i = 0; i < cases; ++i) {
    const std::string name = "butter" + std::to_string(i);
    SCOPED_TRACE(name);
    const ButterworthCase c = ReadCase(Row(name + ".case"));

    const TransferFunction continuous =
        ContinuousButterworth(c.kind, c.order, c.cutoff);
    const MatrixXd& reference = Value(name + ".continuous");
    for (int k = 0; k <= c.order; ++k) {
      EXPECT_NEAR(continuous.numerator[k], reference(0, k), 1e-12 * reference(0, k));
      EXPECT_NEAR(continuous.denominator[k], reference(1, k), 1e-12 * reference(1, k));
    }

    const auto sections = DigitalButterworth(c.kind, c.order, c.cutoff, 1.0 / c.rate);
    const MatrixXd digital = Multiply(sections, c.order);
    EXPECT_LT(Difference(digital.row(0), Value(name + ".digital").row(0)), 1e-11);
    EXPECT_LT(Difference(digital.row(1), Value(name + ".digital").row(1)), 1e-12);

    const VectorXd frequencies = Row(name + ".frequencies");
    for (Eigen::Index k = 0; k < frequencies.size(); ++k) {
      const auto response = FrequencyResponse(sections, frequencies[k], 1.0 / c.rate);
      const MatrixXd& expected = Value(name + ".response");
      EXPECT_NEAR(response.real(), expected(0, k), 1e-9);
      EXPECT_NEAR(response.imag(), expected(1, k), 1e-9);
    }
  }
}

TEST_F(Scipy, AgreesOnZeroPhaseFiltering) {
  const VectorXd input = Row("filtfilt.input");
  const auto filtered = [&](FilterKind kind, int order, double cutoff) -> MatrixXd {
    return FilterZeroPhase(DigitalButterworth(kind, order, cutoff, 1e-3), input)
        .transpose();
  };
  const MatrixXd low4 = filtered(FilterKind::kLowPass, 4, 100.0);
  EXPECT_LT(Difference(low4, Value("filtfilt.low4")), 1e-12);
  EXPECT_LT(Difference(low4, Value("filtfilt.low4.polynomial")), 1e-11);
  EXPECT_LT(Difference(filtered(FilterKind::kLowPass, 7, 50.0), Value("filtfilt.low7")),
            1e-11);
  const MatrixXd high3 = filtered(FilterKind::kHighPass, 3, 100.0);
  EXPECT_LT(Difference(high3, Value("filtfilt.high3")), 1e-12);
  EXPECT_LT(Difference(high3, Value("filtfilt.high3.polynomial")), 1e-12);
}

TEST_F(Scipy, AgreesOnWelchDensities) {
  const VectorXd input = Row("filtfilt.input");
  for (const auto& [segment, overlap] :
       std::map<Eigen::Index, Eigen::Index>{{256, 128}, {255, 100}, {1500, 0}}) {
    const Spectrum spectrum = WelchDensity(input, 1e-3, segment, overlap);
    const MatrixXd& reference = Value("welch." + std::to_string(segment));
    EXPECT_LT(Difference(spectrum.frequency.transpose(), reference.row(0)), 1e-14);
    EXPECT_LT(Difference(spectrum.density.transpose(), reference.row(1)), 1e-13);
  }
}

TEST_F(Scipy, AgreesOnCentralDifferences) {
  const MatrixXd derivative =
      CentralDifference(Row("filtfilt.input"), 1e-3).transpose();
  EXPECT_LT(Difference(derivative, Value("gradient")), 1e-13);
}

TEST_F(Scipy, AgreesOnSimulation) {
  const VectorXd initial = VectorXd::LinSpaced(6, 0.0, 5e-6);
  for (const std::string prefix : {"lti.zoh.", "lti.bilinear."}) {
    SCOPED_TRACE(prefix);
    const MatrixXd output =
        SimulateLti(System(prefix, 1.0 / 8000.0), Value("lti.input"), initial);
    const MatrixXd& expected = Value(prefix + "output");
    ASSERT_EQ(output.rows(), expected.rows());
    for (Eigen::Index i = 0; i < output.rows(); ++i) {
      EXPECT_LT(Difference(output.row(i), expected.row(i)), 1e-10) << "output " << i;
    }
  }
}

}  // namespace
}  // namespace mjdiag
