#include "mjdiag/discovery/fit/exact_columns.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/discovery/fit/tick_columns.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

ExactColumns ExactColumnsOf(const MachineWith& machine_with, const Machine& other_steps,
                            const MeasuredRun& run, const FilterPath& path,
                            const std::vector<Block>& blocks, const Model& model) {
  const std::vector<Coordinate> coordinates = CoordinatesOf(blocks, model);
  const VectorXd x = Place(coordinates, model);
  std::vector<OtherMachine> others;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const MovedOnce moved = Moved(coordinates, model, static_cast<Index>(i));
    others.push_back({machine_with(moved.model), moved.step});
  }
  for (std::size_t m = 0; m < model.size(); ++m) {
    others.push_back({machine_with(Without(model, m))});
  }
  others.push_back({other_steps});
  std::vector<Column> columns = TickColumns(machine_with(model), run, path, others);
  ExactColumns exact{std::vector<Term>(model.size()), std::move(columns.back())};
  std::vector<Term>& terms = exact.terms;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    Term& term = terms[coordinates[i].member];
    term.columns.push_back(std::move(columns[i]));
    const auto known = coordinates[i].is_known ? -x[static_cast<Index>(i)] : 0.0;
    const Index count = std::ssize(term.columns);
    term.mean.conservativeResize(count);
    term.mean[count - 1] = known;
    term.known.push_back(coordinates[i].is_known);
  }
  for (std::size_t m = 0; m < model.size(); ++m) {
    terms[m].block = model[m].block;
    // What is known may be far off (SizePrice), what shapes a law is wide.
    constexpr double kWide = 3.0;
    terms[m].sd = VectorXd::Constant(terms[m].mean.size(), kWide);
    terms[m].removed = std::move(columns[coordinates.size() + m]);
  }
  return exact;
}

}  // namespace mjdiag
