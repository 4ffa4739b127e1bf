#include "mjdiag/diagnosis/residuals/filter_bank.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/KroneckerProduct>

#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void Check(const Denominator& denominator, double sample_time, Index degree) {
  if (denominator.order < 1) {
    throw InputError("denominator", "order " + std::to_string(denominator.order),
                     "1 or more");
  }
  if (denominator.order < degree) {
    throw InputError("denominator", "order " + std::to_string(denominator.order),
                     "at least the degree of the numerator, " + std::to_string(degree));
  }
  if (!(denominator.cutoff > 0.0 && denominator.cutoff < 0.5 / sample_time)) {
    throw InputError("denominator", "cut-off " + std::to_string(denominator.cutoff),
                     "more than 0 and less than half the sampling rate, " +
                         std::to_string(0.5 / sample_time) + " Hz");
  }
}

/// d(p), monic, coefficients of p^0 .. p^order.
VectorXd Polynomial(const Denominator& denominator, double sample_time) {
  const int n = denominator.order;
  const double radius = 2.0 * std::numbers::pi * denominator.cutoff;
  std::vector<std::complex<double>> coefficients{1.0};
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * (2 * i + 1 + n) / (2.0 * n);
    const auto pole =
        (std::exp(std::polar(radius, angle) * sample_time) - 1.0) / kDeltaScale;
    coefficients.emplace_back(0.0);
    for (std::size_t k = coefficients.size() - 1; k > 0; --k) {
      coefficients[k] = coefficients[k - 1] - pole * coefficients[k];
    }
    coefficients[0] *= -pole;
  }
  VectorXd real(n + 1);
  for (int k = 0; k <= n; ++k)
    real[k] = coefficients[static_cast<std::size_t>(k)].real();
  return real;
}

/// sum_k A^k' c c' A^k of a chain.
MatrixXd OutputGramian(const FilterBank& bank) {
  const Index n = bank.order();
  const MatrixXd chain = ChainMatrix(bank).transpose();
  const MatrixXd equations =
      MatrixXd::Identity(n * n, n * n) - Eigen::kroneckerProduct(chain, chain).eval();
  VectorXd right = VectorXd::Zero(n * n);
  right[n * n - 1] = 1.0;
  const VectorXd solution = Solve(equations, right);
  const MatrixXd gramian = solution.reshaped(n, n);
  return 0.5 * (gramian + gramian.transpose());
}

}  // namespace

FilterBank MakeFilterBank(const Numerators& numerators, const Denominator& denominator,
                          double sample_time) {
  const Index degree = static_cast<Index>(numerators.size()) - 1;
  Check(denominator, sample_time, degree);
  const Index n = denominator.order;
  const Index m = numerators.front().rows();
  const Index nz = numerators.front().cols();
  const VectorXd d = Polynomial(denominator, sample_time);
  // q = p / corner has a monic denominator with coefficients of order one.
  const double corner = std::pow(std::abs(d[0]), 1.0 / static_cast<double>(n));
  const auto numerator = [&](Index k) -> MatrixXd {
    if (k > degree) return MatrixXd::Zero(m, nz);
    return std::pow(corner, static_cast<double>(k - n)) *
           numerators[static_cast<std::size_t>(k)];
  };
  FilterBank bank;
  bank.sample_time = sample_time;
  bank.gain = kDeltaScale * corner;
  bank.feedback.resize(n);
  bank.D = numerator(n);
  bank.B.resize(n * m, nz);
  for (Index k = 0; k < n; ++k) {
    bank.feedback[k] = d[k] * std::pow(corner, static_cast<double>(k - n));
    bank.B.middleRows(k * m, m) =
        bank.gain * (numerator(k) - bank.feedback[k] * bank.D);
  }
  return bank;
}

MatrixXd ChainMatrix(const FilterBank& bank) {
  const Index n = bank.order();
  MatrixXd chain = MatrixXd::Identity(n, n);
  chain.diagonal(-1).array() += bank.gain;
  chain.col(n - 1) -= bank.gain * bank.feedback;
  return chain;
}

FilterBank Outputs(const FilterBank& bank, Index first, Index count) {
  const Index m = bank.outputs();
  FilterBank part = bank;
  part.D = bank.D.middleRows(first, count);
  part.B.resize(count * bank.order(), bank.inputs());
  for (Index k = 0; k < bank.order(); ++k) {
    part.B.middleRows(k * count, count) = bank.B.middleRows(k * m + first, count);
  }
  return part;
}

MatrixXd OutputCovariance(const FilterBank& bank, const VectorXd& noise_sd) {
  const Index n = bank.order();
  const Index m = bank.outputs();
  const MatrixXd gramian = OutputGramian(bank);
  const MatrixXd direct = bank.D * noise_sd.asDiagonal();
  MatrixXd covariance = direct * direct.transpose();
  for (Index i = 0; i < n; ++i) {
    const MatrixXd left = bank.B.middleRows(i * m, m) * noise_sd.asDiagonal();
    for (Index j = 0; j < n; ++j) {
      const MatrixXd right = bank.B.middleRows(j * m, m) * noise_sd.asDiagonal();
      covariance += gramian(i, j) * left * right.transpose();
    }
  }
  return covariance;
}

Eigen::MatrixXcd FrequencyResponse(const FilterBank& bank, double frequency) {
  using std::numbers::pi;
  const Index n = bank.order();
  const Index m = bank.outputs();
  const auto z = std::polar(1.0, 2.0 * pi * frequency * bank.sample_time);
  // What a unit of drive into each stage gives at the last one: c^T (z I - A)^-1.
  const Eigen::MatrixXcd resolvent =
      z * Eigen::MatrixXcd::Identity(n, n) - ChainMatrix(bank);
  const Eigen::VectorXcd weight =
      SolveComplex(resolvent.transpose(), Eigen::VectorXcd::Unit(n, n - 1));
  Eigen::MatrixXcd response = bank.D.cast<std::complex<double>>();
  for (Index k = 0; k < n; ++k) response += weight[k] * bank.B.middleRows(k * m, m);
  return response;
}

Index SettlingSamples(const FilterBank& bank, double fraction) {
  return static_cast<Index>(
      std::ceil(std::log(fraction) / std::log(SpectralRadius(ChainMatrix(bank)))));
}

RunningBank::RunningBank(FilterBank bank)
    : bank_(std::move(bank)),
      states_(MatrixXd::Zero(bank_.outputs(), bank_.order())),
      settle_(
          Inverse(MatrixXd::Identity(bank_.order(), bank_.order()) - ChainMatrix(bank_))
              .transpose()),
      drive_(bank_.B.rows()),
      output_(bank_.outputs()) {}

void RunningBank::KeepFirst(Index outputs) {
  bank_ = Outputs(bank_, 0, outputs);
  states_ = MatrixXd(states_.topRows(outputs));
  drive_.resize(bank_.B.rows());
  output_.resize(outputs);
}

void RunningBank::Settle(const VectorXd& z) noexcept {
  drive_.noalias() = bank_.B * z;
  states_.noalias() = drive_.reshaped(bank_.outputs(), bank_.order()) * settle_;
}

template <int kCount>
void RunningBank::StepGroups(Index first, const VectorXd& z) noexcept {
  for (; first + kCount <= bank_.outputs(); first += kCount) {
    StepGroup<kCount>(first, z);
  }
  if constexpr (kCount > 1) StepGroups<kCount / 2>(first, z);
}

template <int kCount>
void RunningBank::StepGroup(Index first, const VectorXd& z) noexcept {
  const auto group = [&](auto&& column) {
    return column.template segment<kCount>(first);
  };
  const Index m = bank_.outputs();
  const Index last_stage = bank_.order() - 1;
  using Outputs = Eigen::Matrix<double, kCount, 1>;
  const Outputs last = group(states_.col(last_stage));
  Outputs output = last;
  for (Index i = 0; i < z.size(); ++i) output += z[i] * group(bank_.D.col(i));
  group(output_) = output;
  // From the last stage down, so that every stage sees its predecessor's old state.
  for (Index k = last_stage; k >= 0; --k) {
    Outputs next = group(states_.col(k)) - (bank_.gain * bank_.feedback[k]) * last;
    if (k > 0) next += bank_.gain * group(states_.col(k - 1));
    for (Index i = 0; i < z.size(); ++i) {
      next += z[i] * group(bank_.B.col(i).segment(k * m, m));
    }
    group(states_.col(k)) = next;
  }
}

const VectorXd& RunningBank::Step(const VectorXd& z) noexcept {
  constexpr int kLargestGroup = 8;
  StepGroups<kLargestGroup>(0, z);
  return output_;
}

MatrixXd FilterSignals(const FilterBank& bank, const MatrixXd& signals) {
  RunningBank running(bank);
  MatrixXd outputs(bank.outputs(), signals.cols());
  VectorXd z(signals.rows());
  for (Index k = 0; k < signals.cols(); ++k) {
    z = signals.col(k);
    outputs.col(k) = running.Step(z);
  }
  return outputs;
}

}  // namespace mjdiag
