#pragma once
// What measured runs say of the numbers of a machine's plant: the method of Gauss and
// Newton on the innovations of its twin (run_pass.h), all runs about one and the same
// theta. One after the other, each about a point of its own, they would contradict each
// other along directions that are hardly known.
//
// Behind a stiff gain the twin is held on the measured motion and its first order holds
// however far the plant is off; behind a soft one the readings tell more. So numbers are
// learned from the stiffest gain to the softest with which nothing is a surprise.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "mjdiag/diagnosis/twin/run_pass.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/uncertain_machine.h"

namespace mjdiag {

/// Readings and commands of a run, a column a tick.
struct RunSamples {
  Eigen::MatrixXd outputs;  ///< NaN where they were not measured
  Eigen::MatrixXd inputs;
};

/// Of a sensor, the readings that were measured.
Eigen::VectorXd MeasuredReadings(const Eigen::MatrixXd& outputs, Eigen::Index sensor);

class NumberLearner {
 public:
  /// @param noise   of the readings, standard deviations, ny
  /// @param linear  the plant is taken as linear
  /// @param beside  how its numbers are known: UncertaintyOptions without faults
  /// @param before  theta that the machine gets to begin with, logarithms of factors
  NumberLearner(const Machine& machine, const Eigen::VectorXd& noise,
                const std::vector<RunSamples>& runs, bool linear,
                const UncertaintyOptions& beside, const Eigen::VectorXd& before);

  Eigen::VectorXd theta() const { return before_ + own_; }
  /// A root of their covariance.
  Eigen::MatrixXd Root() const;
  const std::vector<Unknown>& unknowns() const { return unknowns_; }
  const std::vector<RunInformation>& said() const { return said_; }
  std::size_t stiffest() const { return gains_.size() - 1; }
  /// Passes over all runs so far.
  int passes() const { return done_; }

  /// With that gain, from where it is.
  /// @param rough  it is followed by another one
  void Learn(std::size_t gain, bool rough);

  /// Whether no block of any run is more of a surprise than chance lets expect.
  bool Explains() const { return Excess() <= 1.0; }
  /// How many times more, the worst; infinite if the twin diverges.
  double Excess() const;

  /// Mean square of what all runs leave, over what noise lets expect.
  double Nis() const;

  /// Of the readings, by what changes from one innovation to the next.
  Eigen::VectorXd Noise() const;

 private:
  std::vector<std::shared_ptr<RunPass>> passes_;  // their starts go with them
  std::vector<Unknown> unknowns_;
  std::vector<TwinGain> gains_;
  Eigen::MatrixXd known_;
  Eigen::VectorXd before_, own_;
  Eigen::MatrixXd H_;
  std::vector<RunInformation> said_;
  bool diverged_ = false;
  int done_ = 0;
};

/// The softest gain with which nothing is more of a surprise than `excess` times what
/// chance lets expect, at once or step by step from the stiffest, with which `learner` has
/// learned.
struct SoftestLearner {
  NumberLearner learner;
  std::size_t gain = 0;
  int passes = 0;  ///< of all that were tried
};
/// @param about     a learner of the machine with that theta
/// @param goes_on   asked after each gain, with the softest so far and how many passes it
///                  took; may be empty
SoftestLearner LearnSoftest(
    NumberLearner learner,
    const std::function<NumberLearner(const Eigen::VectorXd& theta)>& about,
    double excess, const std::function<bool(std::size_t gain, int passes)>& goes_on);

}  // namespace mjdiag
