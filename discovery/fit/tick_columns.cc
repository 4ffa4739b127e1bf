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
};

Ticks TicksAlong(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
                 std::size_t record) {
  const Index first = path.first[record];
  const Index end = path.EndOf(record);
  const Machine during = DuringRecord(run.records[record], machine);
  TickMap map(during);
  RecordedInputs inputs(during, run);
  VectorXd forces = VectorXd::Zero(map.model().nv);
  const SharedBodies bodies(map, path);
  VectorXd placed = map.Begun(path.states[static_cast<std::size_t>(first)]).bodies;
  Ticks ticks{{}, MatrixXd::Zero(path.sensors(), end - first)};
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
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    const Ticks own = TicksAlong(machine, run, path, record);
    ParallelFor(static_cast<int>(others.size()), [&](int number) {
      const auto o = static_cast<std::size_t>(number);
      const Ticks ticks = TicksAlong(others[o].machine, run, path, record);
      const Index first = path.first[record];
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
