// What holds for the trials of every effect and fault parameter of the machines of mjcf/.

#include <gtest/gtest.h>

#include <string>

#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/fault_effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Some motion, of everything.
ObservedMotion AnyMotion(const Machine& machine) {
  constexpr Index kSamples = 64;
  const MatrixXd joints = MatrixXd::Random(machine.plant().nv, kSamples);
  const Channels& channels = machine.channels();
  ObservedMotion motion;
  motion.sample_time = machine.rates().tick();
  motion.time = Eigen::VectorXd::LinSpaced(kSamples, 0.0,
                                           (kSamples - 1) * machine.rates().tick());
  motion.position = motion.velocity = motion.acceleration = joints;
  motion.own_acceleration = joints;
  motion.inputs =
      MatrixXd::Random(static_cast<Index>(channels.actuators.size()), kSamples);
  motion.outputs =
      MatrixXd::Random(static_cast<Index>(channels.sensors.size()), kSamples);
  return motion;
}

// A fault parameter of several joints has a signal of each and one amplitude.
TEST(CandidateRegressors, HaveABoundForEachOfTheirAmplitudesOrNone) {
  int bounded = 0, summed = 0;
  const auto check = [&](const CandidateRegressor& trial, const std::string& name) {
    summed += trial.summed;
    if (trial.least.size() == 0) return;
    ++bounded;
    EXPECT_EQ(trial.least.size(), trial.summed ? 1 : trial.signals.cols()) << name;
    EXPECT_LE(trial.least.maxCoeff(), 0.0) << name;
  };
  for (const std::string name : {"ab383", "emps", "servo", "voice_coil"}) {
    const Machine machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/" + name));
    const ObservedMotion motion = AnyMotion(machine);
    const SiteMap map(machine.plant(), machine.linear(), machine.channels());
    std::vector<const Effect*> effects = Effects();
    const std::vector<PlacedEffect> faults = FaultEffects(machine.plant());
    for (const PlacedEffect& fault : faults) effects.push_back(fault.effect.get());
    for (const Effect* effect : effects) {
      for (const Site& site : effect->CandidateSites(map)) {
        const SiteMotion at{machine.plant(), machine.linear(), motion, site};
        const std::string where = name + ": " + effect->name() + "@" + site.name;
        for (const CandidateRegressor& trial : effect->CandidateRegressors(at))
          check(trial, where);
        const auto sweep =
            effect->MakeParameterScan(at, motion.time[motion.samples() - 1]);
        if (sweep) check(sweep->make(sweep->values.front()), where);
      }
    }
  }
  EXPECT_GE(bounded, 20);
  EXPECT_GE(summed, 2);
}

}  // namespace
}  // namespace mjdiag
