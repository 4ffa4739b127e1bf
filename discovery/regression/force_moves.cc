#include "mjdiag/discovery/regression/force_moves.h"

#include "mjdiag/discovery/regression/disturbance_map.h"
#include "mjdiag/plugin/replay/force_smoother.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

/// What a move leaves of the rows of a map.
VectorXd LeftBehind(const ModelMove& move, const std::vector<Term>& terms,
                    const RowMap& map) {
  VectorXd left = map.left();
  for (const std::size_t place : move.removed) {
    left -= map.Of({&terms[place].removed});
  }
  for (const Added& added : move.added) {
    std::vector<const Column*> columns;
    for (const Column& one : added.variation.columns) columns.push_back(&one);
    left -= map.Of(columns) * added.amplitudes;
  }
  return left;
}

}  // namespace

Moves ForceMovesOf(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path, std::vector<Block>& blocks,
                   const std::vector<Term>& terms, Looked looked) {
  looked.at_forces = true;
  const DisturbanceRows missing(path, SmoothForces(path).value);
  DisturbanceMap::Rest rest = DisturbanceMap::RestOf(missing);
  // How lasting the rest is nobody knows before something is explained.
  rest.repeats.setOnes();
  constexpr int kRounds = 2;
  Moves moves;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<DisturbanceMap> maps;
    // A set that is right deserves a smaller rest.
    for (const double part : {1.0, 0.5, 0.25, 0.125}) {
      maps.emplace_back(missing, DisturbanceMap::Rest{part * rest.sd, rest.repeats});
    }
    if (maps.front().rows() == 0) break;
    std::vector<const RowMap*> all;
    for (const DisturbanceMap& one : maps) all.push_back(&one);
    // What physics steps make is no force that lasts.
    moves = MovesOf(machine, run, path, all, blocks, terms, {}, looked);
    if (moves.best.empty()) break;
    rest = maps.front().RestOf(LeftBehind(moves.best.front(), terms, maps.front()));
  }
  return moves;
}

}  // namespace mjdiag
