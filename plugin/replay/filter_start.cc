#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "mjdiag/plugin/machine/tick_differences.h"
#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/operating_point.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd PositionAt(const Machine& machine, const MeasuredRun& run, Index sample) {
  std::map<std::string, double> readings;
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    if (run.measured.size() > 0 && !run.measured(i, sample)) continue;
    readings[machine.channels().sensors[static_cast<std::size_t>(i)].channel] =
        run.outputs(i, sample);
  }
  try {
    return StartPosition(machine.channels(), machine.plant(), machine.rest(), readings);
  } catch (const NumericalError&) {
    // No configuration reads that: the filter finds its way from the rest.
    return machine.rest();
  }
}

/// The rate of a reading at the start of a record: the slope of a line through as many samples
/// as agree with shorter lines, within two standard deviations of each (O. V. Lepskii, "On a
/// Problem of Adaptive Estimation in Gaussian White Noise", Theory Probab. Appl. 35, 1991).
struct Rate {
  double value = 0.0;
  double sd = 0.0;
};
Rate FirstRate(const VectorXd& readings, double sd, double sample_time) {
  Rate rate;
  double low = -std::numeric_limits<double>::infinity();
  double high = -low;
  for (Index count = 2; count <= readings.size(); count *= 2) {
    const VectorXd t =
        VectorXd::LinSpaced(count, -0.5, 0.5) * static_cast<double>(count - 1);
    const double squares = t.squaredNorm();
    const double slope = t.dot(readings.head(count)) / squares / sample_time;
    const double margin = 2.0 * sd / std::sqrt(squares) / sample_time;
    low = std::max(low, slope - margin);
    high = std::min(high, slope + margin);
    if (low > high) break;
    // What is bent may be off by as much as the lines may differ.
    rate = {slope, 2.0 * margin};
  }
  return rate;
}

/// Root mean squares of the readings' rates over a run, over 20 ms.
VectorXd TypicalRates(const MeasuredRun& run) {
  const auto over =
      std::max<Index>(1, static_cast<Index>(std::lround(0.02 / run.sample_time)));
  VectorXd squares = VectorXd::Zero(run.outputs.rows());
  double count = 0.0;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    const Index begin = run.records[r].sample;
    for (Index k = begin; k + over < begin + run.SamplesOf(r); k += over) {
      squares += (run.outputs.col(k + over) - run.outputs.col(k)).cwiseAbs2();
      count += 1.0;
    }
  }
  return (squares / std::max(1.0, count)).cwiseSqrt() /
         (run.sample_time * static_cast<double>(over));
}

/// Sets the inputs of a tick of a run in a machine and takes the tangent there.
/// @param dofs  those whose forces are asked for
TickTangent TangentAt(TickMap& map, RecordedInputs& inputs, const PlantState& state,
                      Index sample, double tick, const std::vector<Index>& dofs) {
  const VectorXd none = VectorXd::Zero(map.model().nv);
  inputs.StayAt(sample);
  const PlantState begun = map.Begun(state);
  map.Run(begun, none, 0, inputs);
  return TickDifferences(map, tick, dofs).Of(begun, none, 0, inputs);
}

/// Degrees of freedom in the order in which a missing force is looked for: of every actuator
/// the one that it moves most, then all others that actuators move, then the rest.
std::vector<Index> InOrderOfDrive(const mjModel& model, const PlantState& state) {
  PlantForces forces(model, state.position);
  const VectorXd inertia = forces.Mass().diagonal();
  std::vector<Index> order;
  const auto add = [&order](Index dof) {
    if (std::ranges::find(order, dof) == order.end()) order.push_back(dof);
  };
  std::vector<Index> moved;
  for (int i = 0; i < model.nu; ++i) {
    const VectorXd arm = VectorXd::Map(
        RowOf(forces.data().actuator_moment, static_cast<int>(model.nv), i), model.nv);
    if (arm.isZero(0.0)) continue;
    Index most = 0;
    (arm.array().square() / inertia.array()).maxCoeff(&most);
    add(most);
    for (Index dof = 0; dof < model.nv; ++dof) {
      if (arm[dof] != 0.0) moved.push_back(dof);
    }
  }
  for (const Index dof : moved) add(dof);
  for (Index dof = 0; dof < model.nv; ++dof) add(dof);
  return order;
}

PlantState StillAt(const Machine& machine, const MeasuredRun& run, Index sample) {
  const mjModel& model = machine.plant();
  PlantState state{PositionAt(machine, run, sample), VectorXd::Zero(model.nv),
                   VectorXd::Zero(model.na)};
  // Filters and muscles settle at their commands; what integrates was nowhere before.
  for (int i = 0; i < model.nu; ++i) {
    const int activation = ActivationOf(model, i);
    if (activation < 0 || model.actuator_dyntype[i] == mjDYN_INTEGRATOR) continue;
    for (std::size_t c = 0; c < machine.actuator_addresses().size(); ++c) {
      if (machine.actuator_addresses()[c] != i) continue;
      state.activation[activation] = run.inputs(static_cast<Index>(c), sample);
    }
  }
  return state;
}

/// Where a record begins.
/// @param rates  of the readings of the whole run (TypicalRates)
FilterStart StartOf(const Machine& machine, const MeasuredRun& run, std::size_t r,
                    const VectorXd& reading_sd, const VectorXd& rates) {
  const Index nv = machine.plant().nv;
  const Index first = run.records[r].sample;
  const Machine during = DuringRecord(run.records[r], machine);
  TickMap map(during);
  RecordedInputs inputs(during, run);
  const mjModel& model = map.model();
  FilterStart start;
  start.state = StillAt(during, run, first);
  const TickTangent tangent =
      TangentAt(map, inputs, start.state, first, during.rates().tick(), {});
  MatrixXd seen = tangent.C.leftCols(nv);
  for (Index i = 0; i < seen.rows(); ++i) {
    // A rate of a velocity or of a force says nothing of velocities.
    const bool position =
        tangent.C.row(i).segment(nv, nv).isZero(0.0) && !map.ReadsAtEnd(i);
    if (!position) seen.row(i).setZero();
  }
  // Of all motions that give such readings that which strains the springs least.
  VectorXd weight(nv);
  for (Index dof = 0; dof < nv; ++dof) {
    weight[dof] = 1.0 / (1.0 + model.jnt_stiffness[model.dof_jntid[dof]]);
  }
  const VectorXd scale = reading_sd.cwiseInverse();
  const MatrixXd weighted = scale.asDiagonal() * seen * weight.cwiseSqrt().asDiagonal();
  const MatrixXd place =
      weight.cwiseSqrt().asDiagonal() * PseudoInverse(weighted) * scale.asDiagonal();
  VectorXd rate(seen.rows());
  VectorXd rate_sd(seen.rows());
  for (Index i = 0; i < seen.rows(); ++i) {
    const Rate first_rate =
        FirstRate(run.outputs.row(i).segment(first, run.SamplesOf(r)).transpose(),
                  reading_sd[i], run.sample_time);
    rate[i] = first_rate.value;
    rate_sd[i] = first_rate.sd;
  }
  start.state.velocity = place * rate;

  const VectorXd mass = PlantForces(model, start.state.position).Mass().diagonal();
  constexpr double kKnownTo = 10.0;  // times the noise of the readings
  const MatrixXd squared = place.cwiseAbs2();
  const VectorXd reading_variance = squared * reading_sd.cwiseAbs2();
  const VectorXd rate_variance = squared * rate_sd.cwiseAbs2();
  VectorXd position = kKnownTo * reading_variance.cwiseSqrt();
  VectorXd speed = rate_variance.cwiseSqrt();
  // Of the usual motion: its energy, and the force that makes it within 20 ms.
  const VectorXd usual = place * rates;
  start.usual = usual.cwiseAbs();
  const double energy = mass.dot(start.usual.cwiseAbs2());
  const double force = mass.dot(start.usual) / 0.02;
  for (Index dof = 0; dof < nv; ++dof) {
    const double stiffness = model.jnt_stiffness[model.dof_jntid[dof]];
    constexpr double kAnywhere = 0.1;  // m or rad
    if (stiffness > 0.0) {
      const double strain = std::min(kAnywhere, force / stiffness);
      position[dof] = std::hypot(position[dof], strain);
      speed[dof] = std::hypot(speed[dof], strain * std::sqrt(stiffness / mass[dof]));
    } else if (position[dof] == 0.0) {
      position[dof] = kAnywhere;
      speed[dof] = energy > 0.0 ? std::sqrt(energy / mass[dof]) : kAnywhere;
      start.usual[dof] = speed[dof];
    }
  }
  const double command = run.inputs.size() > 0 ? run.inputs.cwiseAbs().maxCoeff() : 1.0;
  start.sd.resize(TangentSize(model));
  start.sd << position, speed, VectorXd::Constant(model.na, std::max(1e-3, command));
  return start;
}

}  // namespace

std::vector<Index> LatentDofs(const Machine& machine, const MeasuredRun& run) {
  TickMap map(machine);
  RecordedInputs inputs(machine, run);
  const PlantState state = StillAt(machine, run, 0);
  const mjModel& model = map.model();
  const TickTangent tangent =
      TangentAt(map, inputs, state, 0, machine.rates().tick(), AllDofs(model));
  // What a force that lasts two ticks does to the readings, of each sensor in its own size.
  MatrixXd seen = tangent.C * (tangent.A * tangent.B + tangent.B) + tangent.D;
  for (Index i = 0; i < seen.rows(); ++i) {
    const double largest = seen.row(i).cwiseAbs().maxCoeff();
    if (largest > 0.0) seen.row(i) /= largest;
  }
  const std::vector<Index> order = InOrderOfDrive(model, state);
  std::vector<Index> dofs;
  MatrixXd basis(seen.rows(), 0);
  constexpr double kTold = 0.05;  // of a column that others do not say
  for (const Index dof : order) {
    if (basis.cols() >= seen.rows()) break;
    const VectorXd column = seen.col(dof);
    const VectorXd rest = column - basis * (basis.transpose() * column);
    if (column.norm() < 1e-6 || rest.norm() < kTold * column.norm()) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = rest.normalized();
    dofs.push_back(dof);
  }
  std::ranges::sort(dofs);
  return dofs;
}

std::vector<FilterStart> FilterStarts(const Machine& machine, const MeasuredRun& run,
                                      const VectorXd& reading_sd) {
  const VectorXd rates = TypicalRates(run);
  std::vector<FilterStart> starts;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    starts.push_back(StartOf(machine, run, r, reading_sd, rates));
  }
  return starts;
}

}  // namespace mjdiag
