#pragma once
// Signals that trials are made of (trial.h), along an observed motion.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"

namespace mjdiag {

/// max - min
double Range(const Eigen::VectorXd& x);

/// `count` values from `least` to `most`, evenly spaced by ratio.
std::vector<double> LogGrid(double least, double most, int count);

/// -1, 0 or 1.
double Sign(double x);

/// tanh(v / v0) with v0 a two-hundredth of the largest speed: the sign of v where the
/// joint moves, and nothing where it rests.
Eigen::VectorXd Direction(const Eigen::VectorXd& velocity);

/// z that follows q with a memory of `length`, dz = dq - |dq| z / length (Dahl).
Eigen::VectorXd Follow(const Eigen::VectorXd& q, double length);

/// u one sample later; the first is held.
Eigen::VectorXd Delayed(const Eigen::VectorXd& u);

/// u behind a first-order low-pass with that time constant [samples].
Eigen::VectorXd Lagged(const Eigen::VectorXd& u, double time_constant);

/// Force of a mass of 1 that hangs on q by a spring and a damper.
Eigen::VectorXd AppendagePull(const Eigen::VectorXd& q, double frequency,
                              double damping_ratio, double sample_time);

/// How joint `joint` of a linear plant moves if its spring is stiffer by `added` [N/m],
/// where it moves as q with the spring it has: q + d with
///   M d'' + D d' + (K + added e e^T) d = -added q e
/// @param step  of the physics, by semi-implicit Euler [s]
/// NumericalError if the plant with that spring falls over.
Eigen::VectorXd MotionWithSpring(MechanicalModel model, Eigen::Index joint,
                                 double added, const Eigen::VectorXd& q,
                                 double sample_time, double step);

/// (x[k+1] - x[k-1]) / 2 T along rows, one-sided at the ends.
Eigen::MatrixXd CentralDifferences(const Eigen::MatrixXd& x, double sample_time);

}  // namespace mjdiag
