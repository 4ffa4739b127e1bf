#pragma once
// The gains of the filter of a path behind a noise (force_filter.h), kept: what other
// machines are followed with along the same run, so that their innovations differ by what
// the machines do and by nothing else.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// How many times its variance every reading has behind the path's own noise, ny x samples.
Eigen::MatrixXd OverdispersionAlong(const FilterPath& path);

struct KeptGains {
  struct Reading {
    Eigen::Index sensor = 0;
    Eigen::Index sample = 0;
    bool late = false;
  };
  /// Rows that are taken in a tick.
  struct Tick {
    Eigen::Index first = 0;
    Eigen::Index end = 0;
  };

  std::vector<Reading> readings;  ///< in the order in which they are taken: rows
  std::vector<Tick> ticks;        ///< of every sample
  Eigen::MatrixXd K, C;           ///< (ns + nf + 1) x rows
  Eigen::VectorXd inverse_sd;     ///< 1 / sqrt(S), rows
  Eigen::VectorXd left;           ///< innovations of the path's machine over sqrt(S)
  Eigen::VectorXd rho;            ///< of [w; t] in a tick
  double log_determinant = 0.0;   ///< sum of ln S

  Eigen::Index rows() const { return left.size(); }
};

/// @param inflation  of every reading, whatever the noise: machines and noises are compared
///                   on the same data
KeptGains KeepGains(const FilterPath& path, const FilterNoise& noise,
                    const Eigen::MatrixXd& inflation);
/// Behind the path's own noise.
KeptGains KeepGains(const FilterPath& path);

/// Innovations of another machine along the run of the path, over sqrt(S), rows.
/// NumericalError if it diverges.
Eigen::VectorXd PredictAlong(const Machine& machine, const MeasuredRun& run,
                             const FilterPath& path, const KeptGains& gains);
/// What machines that differ from it in pushes (Machine::DiffersInPushes) push with more where
/// it is then, of each nv x samples [N, N m].
std::vector<Eigen::MatrixXd> PushesAlong(const Machine& machine, const MeasuredRun& run,
                                         const FilterPath& path, const KeptGains& gains,
                                         const std::vector<Machine>& others);

}  // namespace mjdiag
