#pragma once
// The filter of a measured run beside a machine: an extended Kalman filter on MuJoCo's own
// control tick, with a latent force at joints in its state,
//
//   x[k+1] = F(x[k], u[k], w[k] + white),   w[k+1] = rho w[k] + ...,   y[k] = h(x[k]) + noise
//
// x = (q, v, act) of any model (plant_state.h), F and h MuJoCo's (tick_map.h), noises as
// FilterNoise has them. A force that is missing lasts, and the latent one has integral
// action: an arm whose friction is missing does not fall. Where a machine stands, swings,
// falls or is held is the same case. Its first order is the tangent of the tick where the
// estimate is (tick_differences.h), taken anew every 10 ms, in which a joint at 3 rad/s turns
// by 30 mrad; whenever constraints switch; and at every tick along joints with effects, by
// the slopes of their forces alone where they look at nothing but their own joint.
//
// Readings are taken one by one (their noises are independent), so that
//
//   -2 ln L = sum over readings of ln S + rho(z),     z = e / sqrt(S),  S = c P c^T + r^2
//
// with rho Huber's, z^2 up to |z| = 4 and linear beyond: a reading that stands for two
// samples must not decide; its pull is that of one at 4 standard deviations.
//
// A filter with another noise is the linear one along the same path: what it finds is a
// deviation from the path, driven by what the path was pulled by. Likelihoods of many noises
// cost no ticks of the machine then.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/machine/plant_state.h"
#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/replay/filter_noise.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Of a record, before its first sample.
struct FilterStart {
  PlantState state;
  Eigen::VectorXd sd;     ///< of the state, in tangent coordinates; of bodies in a path
  Eigen::VectorXd usual;  ///< speeds during the run, by its readings, nv
};

/// Where a machine was, as the filter found it, with all that a filter of other noise needs.
struct FilterPath {
  double sample_time = 0.0;        ///< [s]
  std::vector<Eigen::Index> dofs;  ///< those with a latent force, nf
  std::vector<bool> late;          ///< sensors that read at the end of a tick, ny
  std::vector<TickTangent> tangents;
  std::vector<std::size_t> of_tick;  ///< the tangent of every tick
  std::vector<Eigen::Index> first;   ///< sample at which every record begins
  std::vector<FilterStart> starts;   ///< of every record
  /// That effects add: "flexible_mode@X", and which of those, from 0.
  std::vector<std::pair<std::string, int>> bodies;
  std::vector<PlantState> states;  ///< after the readings of a tick, of every tick
  Eigen::MatrixXd forces;          ///< w there, nf x samples
  Eigen::MatrixXd innovations;     ///< ny x samples, 0 where nothing was measured
  Eigen::MatrixXd speeds;          ///< of readings, ny x samples [unit / s]
  Eigen::VectorXd clock;           ///< t there [s]
  /// [x; w; t] was pulled by, in the tick: by readings at its start, and then by those of
  /// its end. (ns + nf + 1) x samples
  Eigen::MatrixXd pulled, pulled_late;
  Eigen::ArrayXX<bool> counts;  ///< readings that count, ny x samples
  FilterNoise noise;            ///< with which it was found
  double deviance = 0.0;        ///< -2 ln L

  Eigen::Index samples() const { return innovations.cols(); }
  Eigen::Index sensors() const { return innovations.rows(); }
  /// Sample behind the last one of a record.
  Eigen::Index EndOf(std::size_t record) const {
    return record + 1 < first.size() ? first[record + 1] : samples();
  }
  Eigen::Index dof_count() const { return static_cast<Eigen::Index>(dofs.size()); }
  const TickTangent& At(Eigen::Index sample) const {
    return tangents[of_tick[static_cast<std::size_t>(sample)]];
  }
};

/// Degrees of freedom that get a latent force: those that are driven, then those that sensors
/// read, as long as the readings tell them apart; as many as sensors at most.
std::vector<Eigen::Index> LatentDofs(const Machine& machine, const MeasuredRun& run);

/// Where the records of a run begin: positions at which the sensors read what they first
/// read, velocities by the readings' first change.
std::vector<FilterStart> FilterStarts(const Machine& machine, const MeasuredRun& run,
                                      const Eigen::VectorXd& reading_sd);

/// The run beside the machine, its records side by side.
/// NumericalError if the machine diverges.
FilterPath RunForceFilter(const Machine& machine, const MeasuredRun& run,
                          const std::vector<Eigen::Index>& dofs,
                          const std::vector<FilterStart>& starts,
                          const FilterNoise& noise);

}  // namespace mjdiag
