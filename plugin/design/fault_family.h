#pragma once
// What may wear in a machine, as a diagnosis needs it: the fault parameters that its
// plant declares, linear models for any values of them, and the disturbances of its
// setup.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// The linear model of the machine at these fault parameters (1: healthy).
using ModelAt = std::function<MechanicalModel(const Eigen::VectorXd& parameters)>;

struct FaultFamily {
  std::vector<std::string> parameters;  ///< in the plant's order; healthy at 1
  Eigen::VectorXd magnitudes;           ///< c of [AB383], Eq. 22, of each
  /// The linear model for any values of the parameters. These scale dampers, springs
  /// and motors, so that D, K and Gamma are affine in them as long as the equilibrium
  /// stays where it is, and nothing is linearised again; where one of them moves it,
  /// every call linearises.
  ModelAt model_at;
  std::vector<Multisine> disturbances;  ///< on the setup's actuators; healthy at 0

  /// Of the parameters, then of the disturbances.
  std::vector<std::string> Names() const;
  /// For every parameter the models with it moved by -c and +c from healthy ([AB383],
  /// Eq. 22 and 23).
  std::vector<PerturbedModels> Perturbed() const;
  /// The same about other values of the parameters.
  std::vector<PerturbedModels> PerturbedAbout(const Eigen::VectorXd& values) const;
};

/// A sin(2 pi f t + phase) on the commands, nu x samples: one tone of a disturbance of
/// magnitude 1. @param frequency  f [Hz]  @param tick  of samples [s]
Eigen::MatrixXd ToneOf(const Multisine& source, double frequency, double phase,
                       double tick, Eigen::Index samples);

/// InputError if the setup gives a magnitude for a parameter that the plant does not
/// declare.
FaultFamily MakeFaultFamily(const Machine& machine);

}  // namespace mjdiag
