#include "mjdiag/diagnosis/model/dae_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd Stacked(const MatrixXd& upper, const MatrixXd& lower) {
  MatrixXd result(upper.rows() + lower.rows(), upper.cols());
  result << upper, lower;
  return result;
}

}  // namespace

Eigen::MatrixXcd PolynomialMatrix::At(std::complex<double> p) const {
  Eigen::MatrixXcd value = Eigen::MatrixXcd::Zero(rows(), cols());
  for (auto it = coefficients.rbegin(); it != coefficients.rend(); ++it) {
    value = p * value + *it;
  }
  return value;
}

PolynomialMatrix operator*(const PolynomialMatrix& left,
                           const PolynomialMatrix& right) {
  const std::size_t count = left.coefficients.size() + right.coefficients.size() - 1;
  PolynomialMatrix product;
  product.coefficients.assign(count, MatrixXd::Zero(left.rows(), right.cols()));
  for (std::size_t i = 0; i < left.coefficients.size(); ++i) {
    for (std::size_t j = 0; j < right.coefficients.size(); ++j) {
      product.coefficients[i + j] += left.coefficients[i] * right.coefficients[j];
    }
  }
  return product;
}

SignalEntry NoSignal(const StateSpace& system) {
  return {MatrixXd(system.states(), 0), MatrixXd(system.outputs(), 0)};
}

DaeModel MakeDae(const StateSpace& system, const SignalEntry& unknown_inputs,
                 const SignalEntry& faults) {
  const Index nx = system.states();
  const Index ny = system.outputs();
  const Index nd = unknown_inputs.B.cols();
  MatrixXd static_part(nx + ny, nx + nd);
  static_part << system.A, unknown_inputs.B, system.C, unknown_inputs.D;
  MatrixXd derivative_part = MatrixXd::Zero(nx + ny, nx + nd);
  derivative_part.topLeftCorner(nx, nx) = -MatrixXd::Identity(nx, nx);
  MatrixXd known(nx + ny, ny + system.inputs());
  known << MatrixXd::Zero(nx, ny), system.B, -MatrixXd::Identity(ny, ny), system.D;
  return {{{static_part, derivative_part}}, {{known}}, {{Stacked(faults.B, faults.D)}}};
}

DaeModel MakeDae(const StateSpace& system) {
  return MakeDae(system, NoSignal(system), NoSignal(system));
}

MatrixXd BarMatrix(const PolynomialMatrix& polynomial, int degree) {
  const Index rows = polynomial.rows();
  const Index cols = polynomial.cols();
  MatrixXd bar =
      MatrixXd::Zero((degree + 1) * rows, (degree + 1 + polynomial.degree()) * cols);
  for (int shift = 0; shift <= degree; ++shift) {
    for (int i = 0; i <= polynomial.degree(); ++i) {
      bar.block(shift * rows, (shift + i) * cols, rows, cols) =
          polynomial.coefficients[static_cast<std::size_t>(i)];
    }
  }
  return bar;
}

}  // namespace mjdiag
