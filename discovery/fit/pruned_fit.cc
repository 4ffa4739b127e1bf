#include "mjdiag/discovery/fit/pruned_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/discovery/blocks/curve_block.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

ModelFit WithoutIdle(const std::vector<Block>& blocks, ModelFit fit) {
  constexpr double kNothing = 1e-9;  // of what is expected
  for (std::size_t m = fit.model.size(); m-- > 0;) {
    const std::vector<Coordinate> coordinates = CoordinatesOf(blocks, fit.model);
    const VectorXd x = Place(coordinates, fit.model);
    bool is_sized = false;
    bool is_idle = true;
    std::vector<Index> others;
    for (Index i = 0; i < x.size(); ++i) {
      const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
      if (one.member != m) {
        others.push_back(i);
      } else if (one.is_known) {
        is_sized = true;
        is_idle = is_idle && std::abs(x[i]) < kNothing;
      }
    }
    if (!is_sized || !is_idle) continue;
    fit.prior -= blocks[fit.model[m].block].price;
    if (fit.sd.size() == x.size()) fit.sd = VectorXd(fit.sd(others));
    fit.model = Without(fit.model, m);
  }
  return fit;
}

namespace {

bool IsBesideItsCurve(const std::vector<Block>& blocks, const Model& model,
                      std::size_t place) {
  return std::ranges::any_of(model, [&](const Member& other) {
    return IsCurveOf(blocks[other.block], blocks[model[place].block]);
  });
}

}  // namespace

ModelFit Pruned(const std::vector<Block>& blocks, ModelFit fit, const FitOf& fit_of) {
  for (bool again = true; again;) {
    again = false;
    fit = WithoutIdle(blocks, std::move(fit));
    const std::vector<Coordinate> coordinates = CoordinatesOf(blocks, fit.model);
    const VectorXd x = Place(coordinates, fit.model);
    for (std::size_t m = 0; m < fit.model.size() && !again; ++m) {
      if (IsBesideItsCurve(blocks, fit.model, m)) continue;
      double worth = 0.0;
      bool is_sized = false;
      for (std::size_t i = 0; i < coordinates.size(); ++i) {
        const auto place = static_cast<Index>(i);
        if (coordinates[i].member != m || !coordinates[i].is_known) continue;
        is_sized = true;
        worth += std::pow(x[place] / fit.sd[place], 2);
      }
      const double price = blocks[fit.model[m].block].price;
      if (!is_sized || worth > price) continue;
      ModelFit tried = fit_of(Without(fit.model, m));
      again = tried.score() < fit.score();
      if (again) fit = std::move(tried);
    }
  }
  return fit;
}

}  // namespace mjdiag
