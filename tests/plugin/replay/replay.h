#pragma once
// A record beside the machine that it was measured on.

#include <Eigen/Core>

#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag::test {

struct Replay {
  Machine machine;
  MeasuredRun run;
  Observer observer;

  /// With the sensor noise of the setup and the bandwidth that a discovery takes.
  Replay(const Machine& nominal, const Record& measured)
      : machine(nominal),
        run(ToMeasuredRun(nominal.setup(), measured)),
        observer(DesignObserver(nominal.linear(), nominal.rates().step(),
                                nominal.rates().substeps, NoiseOf(nominal.channels()),
                                25.0 / measured.duration())) {}

  /// Its first samples.
  Replay Beginning(Eigen::Index samples) const {
    Replay cut = *this;
    cut.run.outputs = run.outputs.leftCols(samples);
    cut.run.inputs = run.inputs.leftCols(samples);
    return cut;
  }
  InnovationSequence Follow(const Changes& changes, bool states = false) const {
    return RunPredictor(machine, changes, run, observer, states);
  }
  /// Innovations over their standard deviation, stacked sample by sample.
  Eigen::VectorXd Scaled(const InnovationSequence& track) const {
    const Eigen::MatrixXd scaled =
        observer.innovation_sd.cwiseInverse().asDiagonal() * track.innovations;
    return Eigen::Map<const Eigen::VectorXd>(scaled.data(), scaled.size());
  }

 private:
  static Eigen::VectorXd NoiseOf(const Channels& channels) {
    Eigen::VectorXd sd(static_cast<Eigen::Index>(channels.sensors.size()));
    for (Eigen::Index i = 0; i < sd.size(); ++i) {
      sd[i] = channels.sensors[static_cast<std::size_t>(i)].noise_sd;
    }
    return sd;
  }
};

}  // namespace mjdiag::test
