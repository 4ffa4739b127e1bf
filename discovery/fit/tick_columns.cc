#include "mjdiag/discovery/fit/tick_columns.h"

#include <utility>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/replay/shared_bodies.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// What a machine does in the ticks of a record, and reads.
struct Ticks {
  std::vector<PlantState> states;
  MatrixXd readings;  ///< ny x samples of the record
  /// What others push with more, nv x others, of every tick.
  std::vector<MatrixXd> pushes;
};

/// @param pushing  others that differ in pushes alone
Ticks TicksAlong(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
                 std::size_t record, const std::vector<Machine>& pushing) {
  const Index first = path.first[record];
  const Index end = path.EndOf(record);
  const Machine during = DuringRecord(run.records[record], machine);
  TickMap map(during);
  map.TellPushesOf(DuringRecord(run.records[record], pushing));
  RecordedInputs inputs(during, run);
  VectorXd forces = VectorXd::Zero(map.model().nv);
  const SharedBodies bodies(map, path);
  VectorXd placed = map.Begun(path.states[static_cast<std::size_t>(first)]).bodies;
  Ticks ticks{{}, MatrixXd::Zero(path.sensors(), end - first), {}};
  for (Index k = first; k < end; ++k) {
    const PlantState state =
        bodies.Placed(path.states[static_cast<std::size_t>(k)], placed);
    forces(path.dofs) = path.forces.col(k);
    const VectorXd read = map.Read(state, run.TickOf(k));
    inputs.StayAt(k);
    const TickMap::Result& ticked = map.Run(state, forces, run.TickOf(k), inputs);
    for (Index i = 0; i < path.sensors(); ++i) {
      if (!path.late[static_cast<std::size_t>(i)]) {
        ticks.readings(i, k - first) = read[i];
      } else if (k + 1 < end) {
        ticks.readings(i, k + 1 - first) = ticked.reading[i];
      }
    }
    placed = ticked.state.bodies;
    ticks.states.push_back(ticked.state);
    if (!pushing.empty()) ticks.pushes.push_back(map.OtherPushes());
  }
  return ticks;
}

}  // namespace

std::vector<Column> TickColumns(const Machine& machine, const MeasuredRun& run,
                                const FilterPath& path,
                                const std::vector<OtherMachine>& others) {
  const mjModel& model = machine.plant();
  const Index ns = TangentSize(model) + path.states.front().bodies.size();
  const Index samples = path.samples();
  std::vector<MatrixXd> states(others.size(), MatrixXd::Zero(samples, ns));
  std::vector<MatrixXd> readings(others.size(),
                                 MatrixXd::Zero(samples, path.sensors()));
  std::vector<std::size_t> pushing, moving;
  std::vector<Machine> machines_pushing;
  for (std::size_t o = 0; o < others.size(); ++o) {
    const bool pushes = machine.DiffersInPushes(others[o].machine);
    (pushes ? pushing : moving).push_back(o);
    if (pushes) machines_pushing.push_back(others[o].machine);
  }
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    const Index first = path.first[record];
    const Ticks own = TicksAlong(machine, run, path, record, machines_pushing);
    for (std::size_t k = 0; k < own.pushes.size(); ++k) {
      const Index at = first + static_cast<Index>(k);
      const TickTangent& tangent = path.At(at);
      const MatrixXd moved = tangent.B * own.pushes[k];
      const MatrixXd read = tangent.D * own.pushes[k];
      for (std::size_t p = 0; p < pushing.size(); ++p) {
        const std::size_t o = pushing[p];
        const auto column = static_cast<Index>(p);
        states[o].row(at).head(moved.rows()) =
            moved.col(column).transpose() / others[o].step;
        if (at + 1 == path.EndOf(record)) continue;
        for (Index i = 0; i < path.sensors(); ++i) {
          if (!path.late[static_cast<std::size_t>(i)]) continue;
          readings[o](at + 1, i) = read(i, column) / others[o].step;
        }
      }
    }
    ParallelFor(static_cast<int>(moving.size()), [&](int number) {
      const std::size_t o = moving[static_cast<std::size_t>(number)];
      const Ticks ticks = TicksAlong(others[o].machine, run, path, record, {});
      for (std::size_t k = 0; k < ticks.states.size(); ++k) {
        states[o].row(first + static_cast<Index>(k)) =
            Deviation(model, own.states[k], ticks.states[k]).transpose() /
            others[o].step;
      }
      readings[o].middleRows(first, ticks.readings.cols()) =
          (ticks.readings - own.readings).transpose() / others[o].step;
    });
  }
  std::vector<Column> columns(others.size());
  const auto keep = [](const MatrixXd& of, auto& parts) {
    for (Index i = 0; i < of.cols(); ++i) {
      if (!of.col(i).isZero(0.0)) parts.emplace_back(i, of.col(i));
    }
  };
  for (std::size_t o = 0; o < others.size(); ++o) {
    keep(states[o], columns[o].states);
    keep(readings[o], columns[o].readings);
  }
  return columns;
}

}  // namespace mjdiag
