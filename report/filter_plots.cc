#include "mjdiag/report/filter_plots.h"

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXd;

/// The highest frequency over the lowest.
constexpr double kSpan = 4000.0;
constexpr Index kPoints = 401;

VectorXd Magnitudes(const VectorXd& frequency,
                    const std::function<double(double)>& magnitude) {
  return frequency.unaryExpr(magnitude);
}

/// Standard deviation of each sensor's noise; ones if no sensor has any.
VectorXd NoiseUnits(const DiagnosisDesign& design) {
  const VectorXd& noise = design.sensor_noise;
  return noise.isZero(0.0) ? VectorXd::Ones(noise.size()) : noise;
}

BodePlot MakePlot(const DiagnosisDesign& design, std::string caption,
                  std::string quantity) {
  BodePlot plot;
  plot.caption = std::move(caption);
  plot.quantity = std::move(quantity);
  plot.frequency = BodeFrequencies(design.sample_time());
  return plot;
}

VectorXd HighPassMagnitude(const DiagnosisDesign& design, const VectorXd& frequency) {
  return Magnitudes(frequency, [&](double f) {
    return std::abs(
        FrequencyResponse(design.disturbance.high_pass, f, design.sample_time()));
  });
}

/// |response| of the first output to the signals from `first` on, one curve each.
void AddResponses(BodePlot& plot, const FilterBank& bank, Index first,
                  const std::vector<std::string>& names) {
  const auto count = static_cast<Index>(names.size());
  Eigen::MatrixXd magnitude(count, plot.frequency.size());
  for (Index k = 0; k < plot.frequency.size(); ++k) {
    const MatrixXcd response = FrequencyResponse(bank, plot.frequency[k]);
    magnitude.col(k) = response.block(0, first, 1, count).cwiseAbs().transpose();
  }
  for (Index i = 0; i < count; ++i) {
    plot.curves.push_back({names[static_cast<std::size_t>(i)], magnitude.row(i)});
  }
}

MatrixXcd Response(const MechanicalModel& model, double frequency) {
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency);
  const MatrixXcd stiffness = model.K + s * model.D + s * s * model.M;
  return model.b.transpose() *
         SolveComplex(stiffness, model.Gamma.cast<std::complex<double>>());
}

}  // namespace

VectorXd BodeFrequencies(double sample_time) {
  const double last = std::log10(0.5 / sample_time);
  const VectorXd exponents =
      VectorXd::LinSpaced(kPoints, last - std::log10(kSpan), last);
  return exponents.unaryExpr([](double x) { return std::pow(10.0, x); });
}

VectorXd LowPassMagnitude(const FilterBank& bank, const VectorXd& frequency) {
  // Drive into the first stage alone is the numerator 1.
  const FilterBank low_pass{bank.sample_time, bank.feedback, bank.gain,
                            VectorXd::Unit(bank.order(), 0),
                            Eigen::MatrixXd::Zero(1, 1)};
  const auto magnitude = [&](double f) {
    return std::abs(FrequencyResponse(low_pass, f)(0, 0));
  };
  return Magnitudes(frequency, magnitude) / magnitude(0.0);
}

double HalfPower(const VectorXd& frequency, const VectorXd& magnitude) {
  const double half = std::sqrt(0.5);
  for (Index k = 1; k < frequency.size(); ++k) {
    if (magnitude[k] > half) continue;
    const double part =
        std::log(magnitude[k - 1] / half) / std::log(magnitude[k - 1] / magnitude[k]);
    return frequency[k - 1] * std::pow(frequency[k] / frequency[k - 1], part);
  }
  return frequency[frequency.size() - 1];
}

BodePlot LowPassPlot(const DiagnosisDesign& design) {
  BodePlot plot = MakePlot(design, "Low-passes, the denominators", "gain");
  plot.curves = {{"residual", LowPassMagnitude(design.bank.filters, plot.frequency)},
                 {"disturbance residual",
                  LowPassMagnitude(design.disturbance.filter, plot.frequency)}};
  for (const BodeCurve& curve : plot.curves) {
    const double cutoff = HalfPower(plot.frequency, curve.magnitude);
    plot.marks.push_back({cutoff, "half power at " + FormatQuantity(cutoff, "Hz")});
  }
  return plot;
}

BodePlot HighPassPlot(const DiagnosisDesign& design) {
  BodePlot plot = MakePlot(design, "High-pass of the disturbance residual", "gain");
  const VectorXd high_pass = HighPassMagnitude(design, plot.frequency);
  const VectorXd low_pass = LowPassMagnitude(design.disturbance.filter, plot.frequency);
  plot.curves = {{"high-pass", high_pass},
                 {"with the low-pass", high_pass.cwiseProduct(low_pass)}};
  return plot;
}

BodePlot ReadingResponsePlot(const DiagnosisDesign& design) {
  BodePlot plot = MakePlot(design, "Residual, from the readings", "residual");
  AddResponses(plot, design.bank.filters, 0, design.outputs);
  const VectorXd noise = NoiseUnits(design);
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    plot.curves[i].magnitude *= noise[static_cast<Index>(i)];
  }
  return plot;
}

BodePlot CommandResponsePlot(const DiagnosisDesign& design) {
  BodePlot plot = MakePlot(design, "Residual, from the commands", "residual");
  AddResponses(plot, design.bank.filters, static_cast<Index>(design.outputs.size()),
               design.inputs);
  return plot;
}

BodePlot DisturbanceResponsePlot(const DiagnosisDesign& design) {
  BodePlot plot =
      MakePlot(design, "Disturbance residual, from the commands", "residual");
  AddResponses(plot, design.disturbance.filter,
               static_cast<Index>(design.outputs.size()), design.inputs);
  const VectorXd high_pass = HighPassMagnitude(design, plot.frequency);
  for (BodeCurve& curve : plot.curves) {
    curve.magnitude = curve.magnitude.cwiseProduct(high_pass);
  }
  for (const Multisine& source : design.disturbances) {
    for (const double frequency : source.frequencies) {
      plot.marks.push_back({frequency, "tones of " + source.name});
    }
  }
  return plot;
}

BodePlot ChangePlot(const DiagnosisDesign& design, const MechanicalModel& healthy,
                    const std::vector<ChangedMachine>& changed) {
  BodePlot plot = MakePlot(design, "Change of the machine's response", "change");
  const VectorXd scale = NoiseUnits(design).cwiseInverse();
  for (const ChangedMachine& machine : changed) {
    plot.curves.push_back({machine.label, Magnitudes(plot.frequency, [&](double f) {
                             return (scale.asDiagonal() * (Response(machine.model, f) -
                                                           Response(healthy, f)))
                                 .norm();
                           })});
  }
  return plot;
}

}  // namespace mjdiag
