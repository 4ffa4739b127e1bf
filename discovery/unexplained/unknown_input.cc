#include "mjdiag/discovery/unexplained/unknown_input.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/discovery/unexplained/input_smoother.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewestInnovations = 100;

/// Tick model of the error in units of the noise, no unknown inputs yet.
struct Scaled {
  MatrixXd A, C, L;
  VectorXd state;  ///< units of the states
};

Scaled Scale(const Observer& observer) {
  const Index n = observer.tick.states();
  const double unit = observer.noise_sd.minCoeff();
  Scaled scaled;
  scaled.state.resize(n);
  scaled.state << VectorXd::Constant(n / 2, unit),
      VectorXd::Constant(n / 2, unit / observer.tick.sample_time);
  const VectorXd from = scaled.state.cwiseInverse();
  const VectorXd noise = observer.noise_sd;
  scaled.A = from.asDiagonal() * observer.tick.A * scaled.state.asDiagonal();
  scaled.C =
      noise.cwiseInverse().asDiagonal() * observer.tick.C * scaled.state.asDiagonal();
  scaled.L = from.asDiagonal() * observer.L * noise.asDiagonal();
  return scaled;
}

/// The force that moves a reading by its noise in a tick, for every column of B: z0 of
/// an inertia m and a sensor noise r is m r / T^2. Taken at a tenth of a radian a tick,
/// where structures still move with their axes.
VectorXd ForceUnits(const Scaled& scaled, const MatrixXd& B) {
  constexpr double kAt = 0.1;
  Eigen::MatrixXcd pencil = -scaled.A.cast<std::complex<double>>();
  pencil.diagonal().array() += std::polar(1.0, kAt);
  const MatrixXd gain =
      (scaled.C * SolveComplex(pencil, B.cast<std::complex<double>>())).cwiseAbs();
  VectorXd unit = VectorXd::Zero(B.cols());
  for (Index j = 0; j < B.cols(); ++j) {
    const double strongest = kAt * kAt * gain.col(j).maxCoeff();
    if (strongest > 0.0) unit[j] = 1.0 / strongest;
  }
  return unit;
}

void RequireShapes(const MechanicalModel& model, const Observer& observer,
                   const MatrixXd& innovations, std::size_t sites, std::size_t units) {
  const Index ny = observer.noise_sd.size();
  if (innovations.rows() != ny || innovations.cols() < kFewestInnovations) {
    throw InputError("unknown inputs",
                     std::to_string(innovations.rows()) + " x " +
                         std::to_string(innovations.cols()) + " innovations",
                     std::to_string(ny) + " sensors and at least " +
                         std::to_string(kFewestInnovations) + " samples");
  }
  if (observer.tick.states() != 2 * model.M.rows() || model.b.cols() != ny) {
    throw InputError("unknown inputs", "an observer of another model",
                     "the observer that was designed for it");
  }
  if (!innovations.allFinite()) {
    throw InputError("unknown inputs", "innovations that are not numbers",
                     "finite values");
  }
  if (sites == 0 || (units != 0 && units != sites)) {
    throw InputError(
        "unknown inputs",
        std::to_string(sites) + " sites with " + std::to_string(units) + " units",
        "at least one site and a unit for each or none");
  }
}

/// The system with `inputs` unknown inputs that do nothing yet.
AugmentedSystem Augment(const Scaled& scaled, const Observer& observer, Index inputs,
                        Index samples) {
  const Index nx = scaled.A.rows();
  const Index n = nx + inputs;
  AugmentedSystem system;
  system.slowest = 6.0 * std::numbers::pi / static_cast<double>(samples);
  system.fastest = static_cast<Index>(std::floor(std::log2(1.0 / system.slowest)));
  system.A = MatrixXd::Zero(n, n);
  system.A.topLeftCorner(nx, nx) = scaled.A;
  system.C = MatrixXd::Zero(scaled.C.rows(), n);
  system.C.leftCols(nx) = scaled.C;
  system.L = MatrixXd::Zero(n, scaled.L.cols());
  system.L.topRows(nx) = scaled.L;
  const MatrixXd B = scaled.state.cwiseInverse().asDiagonal() * observer.tick.B;
  const MatrixXd white =
      B * (ForceUnits(scaled, B) * system.slowest * system.slowest).asDiagonal();
  system.Q = MatrixXd::Zero(n, n);
  system.Q.topLeftCorner(nx, nx) = white * white.transpose();
  return system;
}

/// Makes the random walks forget within so many records.
void Forget(AugmentedSystem& system, double records) {
  const double samples = 6.0 * std::numbers::pi / system.slowest;
  system.A.diagonal()
      .tail(system.inputs())
      .setConstant(std::exp(-1.0 / (records * samples)));
}

std::vector<UnknownSignal> Estimate(const AugmentedSystem& system,
                                    const Observer& observer,
                                    const MatrixXd& innovations,
                                    const std::vector<std::string>& sites,
                                    const std::vector<std::string>& units) {
  const MatrixXd e = observer.noise_sd.cwiseInverse().asDiagonal() * innovations;
  const SmoothedInputs inputs = SmoothInputs(system, e);
  std::vector<UnknownSignal> signals(sites.size());
  for (std::size_t j = 0; j < sites.size(); ++j) {
    const auto row = static_cast<Index>(j);
    UnknownSignal& signal = signals[j];
    signal.site = sites[j];
    if (!units.empty()) signal.unit = units[j];
    signal.value = system.unit[row] * inputs.value.row(row).transpose();
    signal.sd = system.unit[row] * inputs.sd[row];
    signal.edge = std::min(inputs.edge[j], e.cols());
    signal.bandwidth =
        inputs.bandwidth[row] / (2.0 * std::numbers::pi * observer.tick.sample_time);
  }
  return signals;
}

}  // namespace

std::vector<UnknownSignal> UnexplainedForces(const MechanicalModel& model,
                                             const Observer& observer, double step,
                                             int substeps, const MatrixXd& innovations,
                                             const std::vector<std::string>& joints,
                                             const std::vector<std::string>& units) {
  RequireShapes(model, observer, innovations, joints.size(), units.size());
  const auto inputs = static_cast<Index>(joints.size());
  if (inputs > observer.noise_sd.size()) {
    throw InputError("unknown inputs", std::to_string(inputs) + " joints",
                     "at most as many as there are sensors");
  }
  MechanicalModel forced = model;
  forced.Gamma = MatrixXd::Zero(model.M.rows(), inputs);
  for (Index j = 0; j < inputs; ++j) {
    const std::string& joint = joints[static_cast<std::size_t>(j)];
    const auto found =
        std::find(model.coordinates.begin(), model.coordinates.end(), joint);
    if (found == model.coordinates.end()) {
      throw InputError("unknown inputs", "no joint '" + joint + "'",
                       "a joint of the plant");
    }
    forced.Gamma(found - model.coordinates.begin(), j) = 1.0;
  }
  const Scaled scaled = Scale(observer);
  const MatrixXd B =
      scaled.state.cwiseInverse().asDiagonal() * TickModel(forced, step, substeps).B;
  AugmentedSystem system = Augment(scaled, observer, inputs, innovations.cols());
  system.unit = ForceUnits(scaled, B);
  system.power = 3.0;
  Forget(system, 1e6);
  system.A.topRightCorner(B.rows(), inputs) = B * system.unit.asDiagonal();
  return Estimate(system, observer, innovations, joints, units);
}

std::vector<UnknownSignal> UnexplainedReadings(const MechanicalModel& model,
                                               const Observer& observer, double step,
                                               int substeps,
                                               const MatrixXd& innovations,
                                               const std::vector<std::string>& units) {
  RequireShapes(model, observer, innovations, model.outputs.size(), units.size());
  if (std::abs(step * substeps / observer.tick.sample_time - 1.0) > 1e-9) {
    throw InputError("unknown inputs", "a tick of " + std::to_string(step * substeps),
                     "that of the observer");
  }
  const Index inputs = observer.noise_sd.size();
  AugmentedSystem system =
      Augment(Scale(observer), observer, inputs, innovations.cols());
  system.unit = observer.noise_sd;
  system.power = 1.0;
  Forget(system, 1.0);
  system.C.rightCols(inputs).setIdentity();
  return Estimate(system, observer, innovations, model.outputs, units);
}

}  // namespace mjdiag
