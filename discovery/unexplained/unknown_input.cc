#include "mjdiag/discovery/unexplained/unknown_input.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "mjdiag/diagnosis/mechanical_model.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/riccati.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewestInnovations = 100;
/// Standard deviation of the state at the first sample, in multiples of the noise.
constexpr double kFree = 1e4;
/// From the n-th doubling on, a sum over 2^n samples is one over any record.
constexpr int kDoublings = 60;

/// xt and the unknown inputs z, in units of the sensor noise: readings in multiples of
/// their noise r, positions of the smallest r, velocities of that in a tick, z of z0.
struct Augmented {
  MatrixXd A;
  MatrixXd C;
  MatrixXd L;      ///< known input: x+ = A x - L e
  MatrixXd Q;      ///< of the white forces on the actuators
  VectorXd unit;   ///< z0 of every unknown input
  double power;    ///< p of s = z0 b^p
  double slowest;  ///< smallest b [rad a tick]
  Index fastest;   ///< largest i of b = slowest 2^i
  Index inputs() const { return unit.size(); }
};

struct Filter {
  MatrixXd F;         ///< A - K C
  MatrixXd G;         ///< K - L: x+ = F x + G e
  MatrixXd P_inputs;  ///< rows of P that belong to the inputs
  MatrixXd weight;    ///< S^-1
  MatrixXd to_state;  ///< C^T S^-1
  MatrixXd W;         ///< see header
  double log_det = 0.0;
  Index memory = 0;  ///< samples after which F has forgotten
  VectorXd sd;       ///< of the smoothed inputs, in z0
  std::vector<Index> edge;
};

/// W, its memory, and sd and edge, which follow from the sums over fewer samples.
void AddSmoother(const MatrixXd& C, Filter& filter) {
  const MatrixXd& P = filter.P_inputs;
  const Index inputs = P.rows();
  const Index offset = P.cols() - inputs;
  std::vector<VectorXd> variance;
  MatrixXd power = filter.F;
  filter.W = filter.to_state * C;
  for (int i = 0; i < kDoublings; ++i) {
    VectorXd now(inputs);
    for (Index j = 0; j < inputs; ++j) {
      now[j] = P(j, offset + j) - P.row(j).dot(filter.W * P.row(j).transpose());
    }
    variance.push_back(now);
    const MatrixXd added = power.transpose() * filter.W * power;
    filter.W += added;
    if (added.norm() <= 1e-14 * filter.W.norm()) break;
    power = power * power;
  }
  filter.memory = Index{1} << std::min<std::size_t>(variance.size(), 40);
  filter.sd = variance.back().cwiseMax(0.0).cwiseSqrt();
  for (Index j = 0; j < inputs; ++j) {
    std::size_t i = 0;
    while (i + 1 < variance.size() && variance[i][j] > 1.44 * variance.back()[j]) ++i;
    filter.edge.push_back(Index{1} << i);
  }
}

/// @param grid  i of every input, b = slowest 2^i
Filter DesignFilter(const Augmented& system, const VectorXd& grid) {
  const Index n = system.A.rows();
  const Index inputs = system.inputs();
  // Inputs in units of the error of their prediction, s / sqrt(b): entries of P are
  // then alike, without which the doubling loses its digits at slow bandwidths.
  VectorXd unit = VectorXd::Ones(n);
  MatrixXd Q = system.Q;
  for (Index j = 0; j < inputs; ++j) {
    const double b = system.slowest * std::exp2(grid[j]);
    unit[n - inputs + j] = std::pow(b, system.power - 0.5);
    Q(n - inputs + j, n - inputs + j) = b;
  }
  const MatrixXd A = unit.cwiseInverse().asDiagonal() * system.A * unit.asDiagonal();
  const MatrixXd P = unit.asDiagonal() *
                     SolveRiccati(A, system.C * unit.asDiagonal(), Q, 1e-11,
                                  "unknown inputs: the covariance does not converge") *
                     unit.asDiagonal();
  const MatrixXd& C = system.C;
  const MatrixXd S = C * P * C.transpose() + MatrixXd::Identity(C.rows(), C.rows());
  const Eigen::LLT<MatrixXd> factor(S);
  Filter filter;
  filter.weight = factor.solve(MatrixXd::Identity(C.rows(), C.rows()));
  filter.to_state = C.transpose() * filter.weight;
  const MatrixXd K = system.A * P * filter.to_state;
  filter.F = system.A - K * C;
  filter.G = K - system.L;
  filter.P_inputs = P.bottomRows(inputs);
  filter.log_det = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  AddSmoother(C, filter);
  return filter;
}

/// nu, ny x samples, of the filter that starts at x; inputs x samples of the predicted
/// inputs go to `predicted` unless it is null.
MatrixXd Innovations(const Augmented& system, const Filter& filter, const MatrixXd& e,
                     const VectorXd& x, MatrixXd* predicted) {
  const Index inputs = system.inputs();
  const Index n = x.size();
  const Index ny = e.rows();
  // [x+; nu] = both [x; e]
  MatrixXd both(n + ny, n + ny);
  both << filter.F, filter.G, -system.C, MatrixXd::Identity(ny, ny);
  VectorXd now(n + ny);
  VectorXd next(n + ny);
  next.head(n) = x;
  MatrixXd nu(ny, e.cols());
  for (Index k = 0; k < e.cols(); ++k) {
    now.head(n) = next.head(n);
    now.tail(ny) = e.col(k);
    if (predicted != nullptr) predicted->col(k) = now.segment(n - inputs, inputs);
    next.noalias() = both * now;
    nu.col(k) = next.tail(ny);
  }
  return nu;
}

/// The backward pass of the smoother: r[k-1], and for every k what it adds to the
/// inputs in `value` unless that is null.
VectorXd PullBackwards(const Filter& filter, const MatrixXd& nu, Index samples,
                       MatrixXd* value) {
  const Index n = filter.F.rows();
  const Index ny = nu.rows();
  MatrixXd both(n, n + ny);
  both << filter.F.transpose(), filter.to_state;
  VectorXd now = VectorXd::Zero(n + ny);
  VectorXd r = VectorXd::Zero(n);
  for (Index k = samples; k-- > 0;) {
    now.head(n) = r;
    now.tail(ny) = nu.col(k);
    r.noalias() = both * now;
    if (value != nullptr) value->col(k).noalias() += filter.P_inputs * r;
  }
  return r;
}

struct Start {
  VectorXd state;
  double log_likelihood = 0.0;
};

/// The free state at the first sample, and the log likelihood of all samples.
Start EstimateStart(const Augmented& system, const Filter& filter, const MatrixXd& e) {
  const Index n = system.A.rows();
  const MatrixXd nu = Innovations(system, filter, e, VectorXd::Zero(n), nullptr);
  const VectorXd pull =
      PullBackwards(filter, nu, std::min(nu.cols(), filter.memory), nullptr);
  const MatrixXd information = kFree * kFree * filter.W + MatrixXd::Identity(n, n);
  const Eigen::LLT<MatrixXd> factor(information);
  Start start;
  start.state = kFree * kFree * factor.solve(pull);
  const double misfit = (filter.weight * nu).cwiseProduct(nu).sum();
  start.log_likelihood = -0.5 * (static_cast<double>(e.cols()) * filter.log_det +
                                 misfit - pull.dot(start.state)) -
                         factor.matrixLLT().diagonal().array().log().sum();
  return start;
}

/// The grid point of the largest likelihood.
class BandwidthSearch {
 public:
  BandwidthSearch(const Augmented& system, const MatrixXd& e)
      : system_(system), e_(e) {}

  VectorXd Run() {
    const Index inputs = system_.inputs();
    for (Index i = 0; i <= system_.fastest; i += 2) {
      Try(VectorXd::Constant(inputs, static_cast<double>(i)));
    }
    for (Index j = 0; j < inputs && inputs > 1; ++j) {
      const VectorXd before = best_;
      for (Index i = 0; i <= system_.fastest; i += 2) {
        Try(Moved(before, j, static_cast<double>(i)));
      }
    }
    for (Index j = 0; j < inputs; ++j) {
      for (const double step : {1.0, 0.5, 0.25}) {
        const double middle = best_[j];
        for (const double to : {middle - step, middle + step}) {
          if (to >= 0.0 && to <= static_cast<double>(system_.fastest)) {
            Try(Moved(best_, j, to));
          }
        }
      }
    }
    return best_;
  }

 private:
  static VectorXd Moved(VectorXd grid, Index j, double to) {
    grid[j] = to;
    return grid;
  }

  void Try(const VectorXd& grid) {
    const double found =
        EstimateStart(system_, DesignFilter(system_, grid), e_).log_likelihood;
    if (found > likelihood_) {
      likelihood_ = found;
      best_ = grid;
    }
  }

  const Augmented& system_;
  const MatrixXd& e_;
  VectorXd best_;
  double likelihood_ = -std::numeric_limits<double>::infinity();
};

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
Augmented Augment(const Scaled& scaled, const Observer& observer, Index inputs,
                  Index samples) {
  const Index nx = scaled.A.rows();
  const Index n = nx + inputs;
  Augmented system;
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
void Forget(Augmented& system, double records) {
  const double samples = 6.0 * std::numbers::pi / system.slowest;
  system.A.diagonal()
      .tail(system.inputs())
      .setConstant(std::exp(-1.0 / (records * samples)));
}

std::vector<UnknownSignal> Estimate(const Augmented& system, const Observer& observer,
                                    const MatrixXd& innovations,
                                    const std::vector<std::string>& sites,
                                    const std::vector<std::string>& units) {
  const MatrixXd e = observer.noise_sd.cwiseInverse().asDiagonal() * innovations;
  const VectorXd grid = BandwidthSearch(system, e).Run();
  const Filter filter = DesignFilter(system, grid);
  const VectorXd start = EstimateStart(system, filter, e).state;
  MatrixXd value(system.inputs(), e.cols());
  const MatrixXd nu = Innovations(system, filter, e, start, &value);
  PullBackwards(filter, nu, nu.cols(), &value);
  std::vector<UnknownSignal> signals(sites.size());
  for (std::size_t j = 0; j < sites.size(); ++j) {
    const auto row = static_cast<Index>(j);
    UnknownSignal& signal = signals[j];
    signal.site = sites[j];
    if (!units.empty()) signal.unit = units[j];
    signal.value = system.unit[row] * value.row(row).transpose();
    signal.sd = system.unit[row] * filter.sd[row];
    signal.edge = std::min(filter.edge[j], e.cols());
    signal.bandwidth = system.slowest * std::exp2(grid[row]) /
                       (2.0 * std::numbers::pi * observer.tick.sample_time);
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
  Augmented system = Augment(scaled, observer, inputs, innovations.cols());
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
  Augmented system = Augment(Scale(observer), observer, inputs, innovations.cols());
  system.unit = observer.noise_sd;
  system.power = 1.0;
  Forget(system, 1.0);
  system.C.rightCols(inputs).setIdentity();
  return Estimate(system, observer, innovations, model.outputs, units);
}

}  // namespace mjdiag
