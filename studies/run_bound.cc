#include "mjdiag/studies/run_bound.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <utility>

#include "mjdiag/plugin/replay/plant_twin.h"
#include "mjdiag/plugin/replay/uncertain_machine.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/bound_study.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStartEnergy = 1.0;  // J

VectorXd NoiseOf(const Machine& machine) {
  VectorXd noise(static_cast<Index>(machine.channels().sensors.size()));
  for (Index i = 0; i < noise.size(); ++i) {
    noise[i] = machine.channels().sensors[static_cast<std::size_t>(i)].noise_sd;
  }
  if (!(noise.array() > 0.0).all()) {
    throw InputError("information bound", "a sensor without noise",
                     "a noise on every sensor");
  }
  return noise;
}

/// A twin that nothing pulls, every tick a block of its own.
std::unique_ptr<Twin> MakeFreeTwin(const Machine& machine,
                                   const UncertainMachine& uncertain,
                                   const VectorXd& noise, bool linear) {
  std::vector<TwinGain> none = {{MatrixXd::Zero(2 * machine.plant().nv, noise.size()),
                                 noise.cwiseAbs2().asDiagonal(), 0}};
  if (linear) {
    return std::make_unique<LinearTwin>(MakeUncertainModel(machine, uncertain),
                                        std::move(none), 1);
  }
  return std::make_unique<PlantTwin>(machine, uncertain, std::move(none), 1);
}

/// theta of the truth.
VectorXd ThetaOf(const Machine& machine, const UncertainMachine& uncertain,
                 const VectorXd& deviations) {
  VectorXd theta = VectorXd::Zero(static_cast<Index>(uncertain.unknowns.size()));
  theta.head(uncertain.faults) = deviations.head(uncertain.faults).array().log1p();
  Index at = uncertain.first_tone();
  Index fault = uncertain.faults;
  for (const MultisineSetup& source : machine.setup().disturbances) {
    // All of its tones are sines.
    for (std::size_t tone = 0; tone < source.frequencies.size(); ++tone, at += 2) {
      theta[at] = deviations[fault];
    }
    ++fault;
  }
  return theta;
}

/// Standard deviations.
VectorXd SpreadOf(const MatrixXd& information) {
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(scale.asDiagonal() * information *
                                    scale.asDiagonal());
  constexpr double kUnexplained = 1e-13;
  if (factor.info() != Eigen::Success || !scale.allFinite() ||
      factor.matrixLLT().diagonal().cwiseAbs2().minCoeff() < kUnexplained) {
    throw NumericalError("this run does not tell all of the faults apart");
  }
  const MatrixXd inverse =
      factor.solve(MatrixXd::Identity(information.rows(), information.cols()));
  return scale.cwiseProduct(inverse.diagonal().cwiseSqrt());
}

}  // namespace

VectorXd RunBound(const Machine& machine, const VectorXd& deviations,
                  const Record& record, Index from, bool linear) {
  UncertaintyOptions options;
  options.friction = !linear;
  options.start_energy = from > 0 ? kStartEnergy : 0.0;
  const UncertainMachine uncertain = MakeUncertainMachine(machine, options);
  const VectorXd noise = NoiseOf(machine);
  const std::unique_ptr<Twin> twin = MakeFreeTwin(machine, uncertain, noise, linear);
  const MatrixXd inputs =
      SamplesOf(record, ChannelsOf(machine.setup().channels.actuators));
  VectorXd reading = VectorXd::Zero(noise.size());
  const VectorXd innovation = VectorXd::Zero(noise.size());
  const auto step = [&](Index k) {
    twin->Predict(reading);
    twin->Step({inputs.col(k).data(), static_cast<std::size_t>(inputs.rows())},
               innovation);
  };

  const VectorXd theta = ThetaOf(machine, uncertain, deviations);
  twin->Start(theta);
  if (from > 0) {
    for (Index k = 0; k < from; ++k) {
      step(k);
      twin->EndBlock();
    }
    TwinState state = twin->MakeState();
    twin->ReadState(state);
    // Nothing is known of it.
    state.S.setZero();
    twin->Start(theta, state, from);
  }
  const Index p = twin->unknowns();
  const Index started = twin->start_unknowns();
  MatrixXd information = MatrixXd::Zero(p, p);
  information.diagonal().tail(started).setOnes();
  MatrixXd whitened(noise.size(), p);
  for (Index k = from; k < inputs.cols(); ++k) {
    step(k);
    whitened.noalias() = noise.cwiseInverse().asDiagonal() * twin->EndBlock();
    information.selfadjointView<Eigen::Lower>().rankUpdate(whitened.transpose());
  }
  information = MatrixXd(information.selfadjointView<Eigen::Lower>());

  const VectorXd all = SpreadOf(information);
  VectorXd bound(deviations.size());
  // Of a factor, not of its logarithm.
  bound.head(uncertain.faults) =
      all.head(uncertain.faults)
          .cwiseProduct((deviations.head(uncertain.faults).array() + 1.0).matrix());
  Index first = uncertain.first_tone();
  Index at = uncertain.faults;
  for (const MultisineSetup& source : machine.setup().disturbances) {
    const auto parts = static_cast<Index>(2 * source.frequencies.size());
    bound[at++] = MagnitudeBound(all.segment(first, parts));
    first += parts;
  }
  return bound;
}

}  // namespace mjdiag
