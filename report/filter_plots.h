#pragma once
// Bode magnitudes of the filters of a diagnosis, from the coefficients that run: what
// the denominators and the high-pass let through ([AB383], Fig. 28 and 29), what the
// residuals make of readings and commands, and how a worn machine answers differently
// (Fig. 30).

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/design/design_facts.h"
#include "mjdiag/report/page/plot.h"

namespace mjdiag {

/// Frequencies [Hz] of these plots: logarithmic, up to half the sampling rate.
Eigen::VectorXd BodeFrequencies(double sample_time);

/// 1 / d of the denominator of a bank, with gain 1 at frequency 0.
/// @return magnitude at every frequency
Eigen::VectorXd LowPassMagnitude(const FilterBank& bank,
                                 const Eigen::VectorXd& frequency);

/// Where a low-pass magnitude has fallen to half power, between frequencies in the
/// logarithms; the last frequency if it does not fall as far.
double HalfPower(const Eigen::VectorXd& frequency, const Eigen::VectorXd& magnitude);

/// Denominators of the residual and of the disturbance residual.
BodePlot LowPassPlot(const DiagnosisDesign& design);
/// The high-pass of the disturbance residual, alone and with its low-pass.
BodePlot HighPassPlot(const DiagnosisDesign& design);

/// From every reading, in standard deviations of its noise (in SI units if no sensor
/// has any), to the first residual.
BodePlot ReadingResponsePlot(const DiagnosisDesign& design);
/// From every command, in SI units, to the first residual.
BodePlot CommandResponsePlot(const DiagnosisDesign& design);
/// From every command to the disturbance residual behind its high-pass, with the
/// frequencies of the known disturbances.
BodePlot DisturbanceResponsePlot(const DiagnosisDesign& design);

/// How far the responses of changed machines are from that of the healthy one, with
/// G = b^T (K + i w D - w^2 M)^-1 Gamma and sigma the noise of each sensor:
///   || diag(sigma)^-1 (G_changed - G) ||_F
/// in standard deviations of the readings per unit of every command.
BodePlot ChangePlot(const DiagnosisDesign& design, const MechanicalModel& healthy,
                    const std::vector<ChangedMachine>& changed);

}  // namespace mjdiag
