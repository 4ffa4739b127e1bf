#pragma once
// The faults of a machine from its twin, as a diagnosis reads them: by the names that
// the plant and the setup give them. A fault parameter is one unknown; a disturbance is
// the sine and the cosine of each of its tones, whose phases nobody knows, and has the
// magnitude of their common factor,
//
//   gamma^2 = sum_i w_i (s_i^2 + c_i^2 - var s_i - var c_i) / sum_i w_i,
//   w_i = 2 / (var s_i + var c_i)
//
// not below 0, with 1 / sum w_i its variance where it is large against that, and the
// interval of magnitude_interval.h.

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/statistics/interval.h"
#include "mjdiag/diagnosis/twin/model_uncertainty.h"
#include "mjdiag/diagnosis/twin/prediction_error.h"

namespace mjdiag {

/// Which of a twin's unknowns a fault is.
struct TwinFault {
  std::string name;
  Eigen::Index first = 0;
  /// Of its tones [Hz]; empty: the one unknown of a fault parameter.
  std::vector<double> frequencies;

  Eigen::Index tones() const { return static_cast<Eigen::Index>(frequencies.size()); }
};

/// A twin with what its unknowns mean.
struct MachineTwin {
  std::unique_ptr<Twin> twin;
  std::vector<Unknown> unknowns;
  std::vector<TwinFault> faults;
  double sample_time = 0.0;  ///< [s]
  /// Of the same machine in healthy runs, and how surprising they may be.
  ModelUncertainty model = {};
  double tolerated = 1.0;
};

/// A normalised innovation squared (NIS) beyond this is no chance and no small error of the model: the run is not
/// explained by any faults, and none is named.
inline constexpr double kLargestNis = 3.0;

/// What a twin says of the faults of its machine. Where it follows, what it says is
/// another estimate after every block, and each may be looked at: named is what would be
/// with a probability of kFalseFault over all of a day, however they depend on each
/// other (Bonferroni).
struct TwinReading {
  Eigen::VectorXd deviation;  ///< from healthy, nf
  Eigen::VectorXd sd;  ///< nf, larger where the twin does not explain what it sees
  /// Between which the deviation lies but for a probability of 5 %, nf.
  std::vector<Interval> ci95;
  std::vector<bool> named;  ///< nf, see NameFaults
  /// Fault parameters, by place, that act as another one does, or not at all.
  std::vector<Eigen::Index> inseparable;
  double nis = 1.0;  ///< squared innovations over what is expected of them
  /// Deviation from which on a fault parameter is named where it is the only one, and
  /// where the healthy machine is as well known as more records could make it, nf; NaN
  /// of disturbances. The same where the model is the machine.
  Eigen::VectorXd alarm, best_alarm;
  int model_runs =
      0;  ///< healthy ones that tell how uncertain the model is; 0: it is not
};

class TwinEstimator {
 public:
  TwinEstimator(MachineTwin machine, const PredictionErrorOptions& options);

  /// One control tick. Does not allocate, lock, throw or do I/O.
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept {
    estimator_.Add(outputs, inputs);
  }
  /// At the end of a run (PredictionErrorEstimator::CatchUp).
  void CatchUp() noexcept { estimator_.CatchUp(); }

  /// The estimate as it is, deviations from healthy, nf. Does not allocate.
  void Read(Eigen::Ref<Eigen::VectorXd> deviation) noexcept;
  /// Its standard deviations, nf. Does not allocate.
  void ReadSpread(Eigen::Ref<Eigen::VectorXd> sd) noexcept;
  /// Sine and cosine of every tone of a disturbance, from the first sample on, 2 tones.
  /// Does not allocate.
  void ReadTones(const TwinFault& fault,
                 Eigen::Ref<Eigen::VectorXd> parts) const noexcept;
  /// The same with what is known of it.
  TwinReading Read() const;

  const std::vector<TwinFault>& faults() const { return faults_; }
  const PredictionErrorEstimator& estimator() const { return estimator_; }

 private:
  /// That anything is named on a healthy machine in one look.
  double FalseNaming() const;
  /// How long the estimate has seen the machine [s].
  double Duration() const;
  /// Covariance of the unknowns with so many times what the model adds to that of noise.
  Eigen::MatrixXd WithModel(const Eigen::MatrixXd& noise, double times) const;
  void FindAlarms(const Eigen::MatrixXd& covariance, Eigen::VectorXd& alarm) const;

  std::vector<TwinFault> faults_;
  ModelUncertainty model_;
  std::vector<Eigen::Index> uncertain_;
  double sample_time_;                       // [s]
  double block_time_;                        // [s]
  Eigen::VectorXd spread_, model_variance_;  // p
  PredictionErrorEstimator estimator_;
};

}  // namespace mjdiag
